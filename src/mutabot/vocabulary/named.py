"""Entries of vocabularies that have a name on a middleware: operations, where the robot is now, and refusals.

One entry stands for all that is done under its name: ``topic`` with ``direction = "publish"`` for publishing
and for setting up the publisher, an action for its goal, feedback, result and cancelling. What a ``current``
like ``{ topic = "/arm/pose" }`` names says where the robot is. Refusals as data are answers, and messages
that follow a command, by which the robot refuses it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from mutabot.model import Case, Kind, Operation, Path, Pattern, Quantity
from mutabot.model.operation import ENDINGS, WRITTEN, Form, Named, Refused, settings_of
from mutabot.settings.mistakes import Check, shown
from mutabot.settings.toml_lines import KeyPath
from mutabot.vocabulary.cases.when import Undecided, in_case, in_cases, read_when

from .patterns import read_patterns
from .quantities import in_message, is_quantity, read_fields, read_quantity, read_result
from .schema import CurrentTable, NamedTable, RefusedTable, read_idle, target_fault

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


#: the kind of target that all of them have
_KIND = "messages"
#: the tables in which quantities stand, by what is done: what it writes, and what it reads
_QUANTITIES: Mapping[Form, tuple[str | None, str | None]] = {
    Form.PUBLISH: ("fields", None),
    Form.RECEIVE: (None, "fields"),
    Form.CALL: ("request", "response"),
    Form.GOAL: ("goal", None),
    Form.FEEDBACK: (None, "feedback"),
    Form.RESULT: (None, "result"),
    Form.PARAMETER: (None, "value"),
    Form.TRANSFORM: (None, "fields"),
}
#: how mistakes call what is written, and what is read
_SIDES: Mapping[Form, tuple[str, str]] = {
    **dict.fromkeys((Form.PUBLISH, Form.RECEIVE), ("what is published", "what is received")),
    Form.CALL: ("request", "response"),
    **dict.fromkeys((Form.GOAL, Form.FEEDBACK, Form.RESULT), ("goal", "feedback or result")),
    **dict.fromkeys((Form.PARAMETER, Form.TRANSFORM), ("what is sent", "what is read")),
}
#: forms that make the robot do something, unless the vocabulary says otherwise
_COMMANDS = frozenset({Form.PUBLISH, Form.CALL, Form.GOAL, Form.CANCEL})
#: keys of those forms alone that write a message
_OF_COMMANDS = (
    *("command", "opposite", "idle", "message", "patterns", "current"),
    *("refusals", "refused", "when"),
)
#: keys for quantities
_TABLES = tuple(dict.fromkeys(key for pair in _QUANTITIES.values() for key in pair if key is not None))


def is_named(raw: Any) -> bool:
    """Whether an entry names an operation on a middleware, rather than a callable."""
    return isinstance(raw, dict) and "call" not in raw and any(key in raw for key in NAMING)


def read_named(check: Check, raw: Any, place: KeyPath) -> list[Operation]:
    """The operations of an entry; none if not even its name can be told. Mistakes are noted."""
    table = check.table(NamedTable, raw, place, salvage=True)
    key = _naming_key(check, table, place) if table is not None else None
    if table is None or key is None:
        return []
    named = _named(check, table, key, place)
    if named is None:
        return []
    forms = forms_of(key, table.direction)
    _check_keys(check, table, key, forms[0], place)
    for index, target in enumerate(table.refusals):
        fault = target_fault(target)
        if fault is not None:
            check.error((*place, "refusals", index), fault)
    return [_operation(check, table, replace(named, form=form), form is forms[0], place) for form in forms]


def _naming_key(check: Check, table: NamedTable, place: KeyPath) -> str | None:
    """Which key names the operation; None if there are several, which is noted."""
    keys = [key for key in NAMING if getattr(table, key) is not None]
    if len(keys) > 1:
        check.error((*place, keys[1]), f"an operation has one name: either {' or '.join(keys)}")
    return keys[0] if len(keys) == 1 else None


def _named(check: Check, table: NamedTable, key: str, place: KeyPath) -> Named | None:
    """The name, with the first of the forms; None if it has mistakes, which are noted."""
    before = len(check.errors)
    if key == "topic":
        _check_direction(check, table.direction, place)
    read: dict[str, str | None] = {}
    for part, read_part in ((key, partial(name_of, key)), ("node", node_of), ("type", type_of)):
        text = getattr(table, part)
        try:
            read[part] = read_part(text) if text is not None else None
        except ValueError as error:
            check.error((*place, part), str(error))
    name = read.get(key)
    if name is None or len(check.errors) > before:
        return None
    return Named(forms_of(key, table.direction)[0], name, read["node"], read["type"])


def _check_direction(check: Check, direction: str | None, place: KeyPath) -> None:
    if direction is None:
        check.error(place, 'a topic needs direction = "publish" or "receive"')
    elif direction not in DIRECTIONS:
        check.unknown((*place, "direction"), "direction", direction, DIRECTIONS)


def _check_keys(check: Check, table: NamedTable, key: str, form: Form, place: KeyPath) -> None:
    """Keys that say nothing of an operation with such a name."""
    fitting = {one for each in forms_of(key, table.direction) for one in _QUANTITIES.get(each, ()) if one}
    what = _what(key, table.direction)
    for other in _TABLES:
        if getattr(table, other) is not None and other not in fitting:
            instead = f"; its quantities stand in {' and '.join(sorted(fitting))}" if fitting else ""
            check.error((*place, other), f"{what} has no {other}{instead}")
    if key != "topic" and table.direction is not None:
        check.error((*place, "direction"), f"{what} has no direction, only a topic has")
    if table.opposite is not None and form in WRITTEN:
        check.error(
            (*place, "opposite"),
            "another name cannot be the opposite: give a text command its opposite in patterns, "
            "or describe a field with two values",
        )
    if form not in WRITTEN:
        for other in _OF_COMMANDS:
            if getattr(table, other) not in (None, []) and not (other == "command" and not table.command):
                check.error((*place, other), f"{what} sends nothing, so it has no {other}")


def _operation(check: Check, table: NamedTable, named: Named, is_main: bool, place: KeyPath) -> Operation:
    """One of the operations of an entry."""
    root = WRITTEN.get(named.form)
    written, read = _QUANTITIES.get(named.form, (None, None))
    raw = getattr(table, written) if written else None
    arguments = settings_of(named.form)
    if raw:
        arguments = read_fields(check, raw, (*place, written or ""), root, _SIDES[named.form])
    result = _read(check, table, named.form, read, place) if read else ()
    source = check.source(place, named.target)
    operation = Operation(
        target=named.target,
        arguments=arguments,
        result=result,
        command=_is_command(table, named.form, arguments, result),
        source=source,
        kind=_KIND,
        named=named,
    )
    if not is_main or root is None:
        return operation
    patterns = read_patterns(check, table.patterns, (*place, "patterns"), source, arguments)
    if table.message is None and not table.patterns:
        arguments, patterns = in_cases(check, arguments, result, table.opposite, source, place)
    operation = replace(
        operation,
        arguments=tuple(one for one in arguments if not isinstance(one, Undecided)),
        current=read_current(check, table.current, (*place, "current")),
        opposite=table.opposite,
        refusals=tuple(table.refusals),
        idle=read_idle(check, table.idle, (*place, "idle")),
        refused=_refused(check, table, named, place),
        message=_message(check, table, root, place),
        patterns=tuple(_in_message(pattern, root) for pattern in patterns),
    )
    if table.when is None:
        return operation
    cases = read_when(check, table.when, (*place, "when"))
    return in_case(operation, tuple(_in_root(case, root) for case in cases))


def _read(check: Check, table: NamedTable, form: Form, key: str, place: KeyPath) -> tuple[Quantity, ...]:
    """What is read: a value as a whole, or fields of a message."""
    raw = getattr(table, key)
    if form is Form.PARAMETER and raw is None:
        return (Quantity(key, Path(), Kind.SETTING),)
    if form is Form.PARAMETER:
        where = (*place, key)
        if not is_quantity(raw):
            return read_result(check, raw, where)
        return tuple(read_quantity(check, raw, where, Path(), written=False, name=key, sides=_SIDES[form]))
    return read_fields(check, raw, (*place, key), None, _SIDES[form])


def _message(check: Check, table: NamedTable, root: str, place: KeyPath) -> str | None:
    """The path to the field with a text command; None if there is none, or a mistake, which is noted."""
    if table.message is None:
        if table.patterns:
            check.error((*place, "patterns"), 'needs message = "…": the field that holds the command')
        return None
    try:
        return _rooted(table.message, root)
    except ValueError:
        check.error((*place, "message"), f"{table.message!r} is not the name of a field")
        return None


def _in_message(pattern: Pattern, root: str) -> Pattern:
    """A command whose arguments beside the text, and whose cases, name fields by their bare paths."""

    def placed(quantity: Quantity) -> Quantity:
        if quantity.name in pattern.fields or str(quantity.path) != quantity.name:
            return quantity  # a field of the text, or one that all commands have
        return replace(quantity, path=in_message(quantity.path, root))

    return replace(
        pattern,
        arguments=tuple(map(placed, pattern.arguments)),
        when=tuple(_in_root(case, root) for case in pattern.when),
    )


def _in_root(case: Case, root: str) -> Case:
    return replace(case, argument=_rooted(case.argument, root))


def _rooted(text: str, root: str) -> str:
    return str(in_message(Path.parse(text, rooted=True), root))


def _refused(check: Check, table: NamedTable, named: Named, place: KeyPath) -> tuple[Refused, ...]:
    action = named.name if named.form is Form.GOAL else None
    answers = named.form is not Form.PUBLISH
    return read_refused(check, table.refused, (*place, "refused"), action=action, answers=answers)


def _is_command(
    table: NamedTable, form: Form, arguments: tuple[Quantity, ...], result: tuple[Quantity, ...]
) -> bool:
    """Whether the robot does something, unless the vocabulary says so itself."""
    if form not in _COMMANDS:
        return False
    if table.command is not None:
        return table.command
    return form is not Form.CALL or bool(arguments or table.patterns) or not result


def _what(key: str, direction: str | None) -> str:
    if key == "topic":
        return f"a topic with direction = {direction!r}".replace("'", '"')
    return {"action": "an action", "tf": "a transform"}.get(key, f"a {key}")
