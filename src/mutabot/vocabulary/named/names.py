"""What names on a middleware stand for: operations, where the robot is now, and refusals.

``current = { topic = "/arm/pose" }`` says where the robot is. Refusals as data are answers, and messages that
follow a command, by which the robot refuses it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from mutabot.model import Path
from mutabot.model.named import ENDINGS, Form, Named, Refused
from mutabot.settings.mistakes import Check, shown
from mutabot.settings.toml_lines import KeyPath
from mutabot.vocabulary.quantities import in_message
from mutabot.vocabulary.schema import CurrentTable, RefusedTable

#: the keys that name an operation, each with the forms that it stands for, the main one first
FORMS: dict[str, tuple[Form, ...]] = {
    "service": (Form.CALL, Form.CLIENT),
    "action": (Form.GOAL, Form.FEEDBACK, Form.RESULT, Form.CANCEL, Form.CLIENT),
    "parameter": (Form.PARAMETER,),
    "timer": (Form.TICK, Form.TIMER),
    "rate": (Form.SLEEP, Form.RATE),
    "tf": (Form.TRANSFORM,),
}
#: what ``topic`` stands for, by its ``direction``
DIRECTIONS: dict[str, tuple[Form, ...]] = {
    "publish": (Form.PUBLISH, Form.ADVERTISE),
    "receive": (Form.RECEIVE, Form.SUBSCRIBE),
}
#: all keys that name an operation on a middleware
NAMING = ("topic", *FORMS)

_TYPE = re.compile(r"(\w+)/(?:(?:msg|srv|action)/)?(\w+)")
_ARROW = re.compile(r"\s*(?:→|->)\s*")
_GRAPH_NAME = re.compile(r"[\w/*~]+")
_PARAMETER = re.compile(r"[\w/*~.\-]+")
_TIMER = re.compile(r"[\w*.<>]+")


def name_of(key: str, text: str) -> str:
    """The name as operations carry it. Raises ValueError, saying what would be right."""
    if key == "tf":
        return _transform(text)
    if not text.strip():
        raise ValueError("is empty")
    allowed = {"parameter": _PARAMETER, "timer": _TIMER}.get(key, _GRAPH_NAME)
    if not allowed.fullmatch(text):
        odd = next(sign for sign in text if not allowed.fullmatch(sign))
        raise ValueError(f"{text!r}: a name has no {odd!r} in it")
    if key not in ("parameter", "timer"):
        _check_resolved(text)
    return text


def node_of(text: str) -> str:
    """The name of a node, which may have ``*`` in it. Raises ValueError likewise."""
    return name_of("node", text)


def type_of(text: str) -> str:
    """``package/Name`` for ``package/msg/Name`` and the like. Raises ValueError for anything else."""
    found = _TYPE.fullmatch(text)
    if found is None:
        raise ValueError(f"{text!r} is no type; expected package/Name, such as geometry_msgs/PoseStamped")
    return f"{found[1]}/{found[2]}"


def forms_of(key: str, direction: str | None) -> Sequence[Form]:
    """The forms that an entry stands for."""
    return DIRECTIONS[direction or ""] if key == "topic" else FORMS[key]


def _check_resolved(text: str) -> None:
    if text.startswith(("/", "*")):
        return
    rest = text.lstrip("~/")
    where = f"*/{rest}" if text.startswith("~") else f"/{rest}"
    raise ValueError(
        f"{text!r} is not resolved: names are compared after namespaces and remapping; write {where!r}"
    )


def _transform(text: str) -> str:
    parts = [part.strip().removeprefix("/") for part in _ARROW.split(text)]
    if len(parts) != 2 or not all(parts):
        raise ValueError(f"{text!r} names no two frames; expected 'base -> tool'")
    return " → ".join(parts)


#: what is read under a name, by the key that names it
_FORMS = {
    "topic": Form.RECEIVE,
    "service": Form.CALL,
    "action": Form.FEEDBACK,
    "parameter": Form.PARAMETER,
    "tf": Form.TRANSFORM,
}


def read_current(check: Check, raw: Any, place: KeyPath) -> str | None:
    """The target of the operation that ``current`` names; None if it names none. Mistakes are noted.

    A text is the target itself.
    """
    if raw is None or isinstance(raw, str):
        return raw
    if not isinstance(raw, dict):
        check.error(place, f'expected a text or a table such as {{ topic = "/arm/pose" }}, got {shown(raw)}')
        return None
    table = check.table(CurrentTable, raw, place)
    if table is None:
        return None
    keys = [key for key in _FORMS if getattr(table, key) is not None]
    if len(keys) != 1:
        check.error(place, f"names one thing: {', '.join(list(_FORMS)[:-1])} or {list(_FORMS)[-1]}")
        return None
    return _target(check, table, keys[0], place)


def _target(check: Check, table: CurrentTable, key: str, place: KeyPath) -> str | None:
    form = _FORMS[key]
    if table.direction is not None and table.direction not in DIRECTIONS:
        check.unknown((*place, "direction"), "direction", table.direction, DIRECTIONS)
        return None
    if table.direction is not None:
        form = DIRECTIONS[table.direction][0]
    try:
        name = name_of(key, getattr(table, key))
        node = node_of(table.node) if table.node is not None else None
    except ValueError as error:
        check.error((*place, key), str(error))
        return None
    return Named(form, name, node).target


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
