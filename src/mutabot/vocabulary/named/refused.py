"""Refusals as data: answers, and messages that follow a command, by which the robot refuses it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mutabot.model import Path
from mutabot.model.named import ENDINGS, Refused
from mutabot.settings.mistakes import Check, shown
from mutabot.settings.toml_lines import KeyPath
from mutabot.vocabulary.quantities import in_message
from mutabot.vocabulary.schema import RefusedTable

from .names import name_of

_FORM = 'such as refused = { path = "status", values = [5, 6] }'


def read_refused(
    check: Check, raw: Any, place: KeyPath, *, action: str | None = None, answers: bool = True
) -> tuple[Refused, ...]:
    """What ``refused`` says: a table, a list of tables, or for an action also how its goal ends.

    Mistakes are noted.

    Args:
        check, raw, place: the document, the value of the key, and where it stands.
        action: resolved name of the action; None for everything else.
        answers: whether the command itself has an answer.
    """
    if raw is None:
        return ()
    if isinstance(raw, list) and raw and all(isinstance(item, str) for item in raw):
        return _read_endings(check, raw, place, action)
    if not isinstance(raw, list):
        return _read_table(check, raw, place, action, answers)
    if not raw:
        check.error(place, f"must not be empty, {_FORM}")
    found: list[Refused] = []
    for index, item in enumerate(raw):
        found += _read_table(check, item, (*place, index), action, answers)
    return tuple(found)


def _read_endings(
    check: Check, raw: Sequence[str], place: KeyPath, action: str | None
) -> tuple[Refused, ...]:
    if action is None:
        check.error(place, f"only the goal of an action ends with a word; {_FORM}")
        return ()
    for index, word in enumerate(raw):
        if word not in ENDINGS:
            check.unknown((*place, index), "end of a goal", word, ENDINGS)
    return (Refused("", tuple(raw), action),)


def _read_table(
    check: Check, raw: Any, place: KeyPath, action: str | None, answers: bool
) -> tuple[Refused, ...]:
    if not isinstance(raw, dict):
        check.error(place, f"expected a table, got {shown(raw)}; {_FORM}")
        return ()
    table = check.table(RefusedTable, raw, place)
    if table is None:
        return ()
    topic = action
    try:
        path = _path(table.path)
    except ValueError as error:
        check.error((*place, "path"), str(error))
        return ()
    if table.topic is not None:
        try:
            topic = name_of("topic", table.topic)
        except ValueError as error:
            check.error((*place, "topic"), str(error))
    elif topic is None and not answers:
        check.error(place, 'what is published has no answer; name where it is said: topic = "/…"')
    if not table.values:
        check.error((*place, "values"), "must not be empty: the values that are refusals")
    for index, value in enumerate(table.values):
        if not isinstance(value, str | bool | int | float):
            where = (*place, "values", index)
            check.error(where, f"must be a text, a number, true or false, not {shown(value)}")
    return (Refused(str(path), tuple(table.values), topic),)


def _path(text: str) -> Path:
    """The path into an answer or a message, which may begin without a dot. Raises ValueError."""
    if not text or text.startswith("["):
        return Path.parse(text, rooted=False)
    try:
        return in_message(Path.parse(text.removeprefix("."), rooted=True), None)
    except ValueError as error:
        raise ValueError(str(error).replace("an argument's name", "the name of a field")) from None
