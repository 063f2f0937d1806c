"""Where the robot is now, by name: ``current = { topic = "/arm/pose" }``."""

from __future__ import annotations

from typing import Any

from mutabot.model.named import Form, Named
from mutabot.settings.mistakes import Check, shown
from mutabot.settings.toml_lines import KeyPath
from mutabot.vocabulary.schema import CurrentTable

from .names import DIRECTIONS, name_of, node_of

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
