"""Read operations, the clock, the wait and probes from the tables of a vocabulary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mutabot.model import ANY, Case, Clock, Kind, Operation, Path, Pattern, Probe, Quantity, Wait
from mutabot.model.operation import ENDINGS, WRITTEN, Form, Named, Refused
from mutabot.model.signature import parse_signature

from . import schema
from .patterns import in_cases, in_each_mode, name_of_cases, read_patterns, read_when
from .quantities import bare_path, in_message, read_quantities
from .schema import OperationTable, Sides

if TYPE_CHECKING:
    from mutabot.config.mistakes import DocumentPlace

#: forms that make the robot do something, unless the vocabulary says otherwise
_COMMANDS = frozenset({Form.PUBLISH, Form.CALL, Form.GOAL, Form.CANCEL})
#: keys of callables, and of those forms alone that write a message
_OF_COMMANDS = {
    *("command", "opposite", "idle", "message", "patterns", "current"),
    *("refusals", "refused", "when"),
}
#: keys that say something of one name alone
_ONLY = {"overrides": "call", "direction": "topic"}
_REFUSED = 'such as refused = { path = "status", values = [5, 6] }'


def read_operations(place: DocumentPlace, raw: Any) -> list[Operation]:
    """Read one ``[[operation]]``: a callable, or all that is done under a name. Mistakes are noted."""
    mistakes = len(place.errors)
    table = place.table(OperationTable, raw, salvage=True)
    keys = [key for key in schema.NAMING if table is not None and getattr(table, key) is not None]
    if len(keys) > 1:
        (place / keys[1]).error(f"an operation is known by one thing: either {keys[0]} or {keys[1]}")
    elif not keys and len(place.errors) == mistakes:
        place.error(
            f"the key 'call' is missing, or another one that names it: {', '.join(schema.NAMING[1:])}"
        )
    if table is None or len(keys) != 1:
        return []
    if keys[0] in ("call", "method"):
        _check_keys(place, table, keys[0])
        return [_read_callable(place, table)]
    if keys[0] == "topic" and "direction" not in raw:
        place.error('a topic needs direction = "publish" or "receive"')
    forms = schema.FORMS.get((keys[0], table.direction if keys[0] == "topic" else None), ())
    names = [Named(form, getattr(table, keys[0]), table.node, table.type) for form in forms]
    if names:
        _check_keys(place, table, keys[0], forms)
    return [_read_operation(place, table, name.target, name, is_main=name is names[0]) for name in names]


def _check_keys(place: DocumentPlace, table: OperationTable, key: str, forms: Sequence[Form] = ()) -> None:
    """Note keys that have no meaning for an operation with such a name."""
    sides = [schema.SIDES[form] for form in forms if form in schema.SIDES] if forms else [schema.CALLABLE]
    fitting = {side_name for side in sides for side_name in (side.written, side.read) if side_name}
    writes = not forms or forms[0] in WRITTEN
    allowed = {key, *fitting, *(("type", "node") if forms else ("signature",))}
    allowed |= {other for other, only in _ONLY.items() if only == key}
    allowed |= _OF_COMMANDS if writes else set() if table.command else {"command"}
    if forms:
        allowed.discard("opposite")
    what = f'a topic with direction = "{table.direction}"' if key == "topic" else f"a {key}"
    what = {"action": "an action", "tf": "a transform"}.get(key, what)
    for other in sorted(table.model_fields_set - allowed):
        (place / other).error(f"{what} has no {other}; it has {', '.join(sorted(allowed))}")


def _read_callable(place: DocumentPlace, table: OperationTable) -> Operation:
    target = table.call or ""
    if table.method is not None:
        target, table = f"{ANY}.{table.method}", table.model_copy(update=_of_any(table))
    operation = _read_operation(place, table, target)
    _check_self(place, operation)
    _check_from_self(place / "patterns", operation)
    if not (table.arguments or table.result or table.message or operation.command):
        place.error("says nothing: no arguments, no result, no patterns, and command = false")
    _check_signature(place, operation)
    return operation


def _of_any(table: OperationTable) -> dict[str, str]:
    """Return the names of methods as targets on an object of any class."""
    names = {"current": table.current, "opposite": table.opposite}
    return {key: f"{ANY}.{name}" for key, name in names.items() if name is not None and schema.is_name(name)}


def _check_self(place: DocumentPlace, operation: Operation) -> None:
    """Note descriptions of the object or class of a callable that is no method."""
    target = operation.target
    if "." in target.partition(":")[2]:
        return
    if operation.overrides:
        (place / "overrides").error(f"{target} is not a method of a class, so nothing overrides it")
    cases = [case.argument for pattern in operation.patterns for case in pattern.when]
    for key, paths in (("message", [operation.message]), ("when", cases)):
        if any(path and Path.parse(path, rooted=True).root == "self" for path in paths):
            (place / key).error(f"{target} is not a method of a class, so it has no self")


def _read_operation(
    place: DocumentPlace,
    table: OperationTable,
    target: str,
    named: Named | None = None,
    *,
    is_main: bool = True,
) -> Operation:
    """Read one of the operations of an entry: a callable, or one form of a name on a middleware."""
    form = named.form if named is not None else None
    sides = schema.CALLABLE if form is None else schema.SIDES.get(form, Sides(None, None))
    written = getattr(table, sides.written) if sides.written else None
    modes = in_each_mode(place / (sides.written or ""), written) if written else []
    described = [(cases, read_quantities(at, raw, sides, is_written=True)) for cases, at, raw in modes]
    settings = form.settings if form is not None else ()
    operation = Operation(
        target=target,
        arguments=described[0][1] if described else settings,
        result=_read_result(place, table, form, sides),
        source=place.source(target),
        kind="messages" if named is not None else "methods" if table.method is not None else None,
        named=named,
    )
    if is_main and (form is None or sides.root is not None):
        operation = _with_commands(place, table, operation, sides, described)
    else:
        operation = replace(operation, command=_is_command(table, operation))
    return operation


def _with_commands(
    place: DocumentPlace,
    table: OperationTable,
    operation: Operation,
    sides: Sides,
    described: list[tuple[tuple[Case, ...], tuple[Quantity, ...]]],
) -> Operation:
    """Return the operation with the settings of calls that write: how to distinguish, undo and refuse them.

    ``described`` are its arguments in each case of their modes.
    """
    source, at = operation.source, place / "patterns"
    if table.patterns:
        patterns = read_patterns(at, table.patterns, source, operation.arguments, sides)
    else:
        patterns = tuple(
            Pattern(name, quantities, operation.result, table.opposite, f"{source} · {name}", when=cases)
            for cases, quantities in described
            if (name := name_of_cases(cases))
        )
    patterns = tuple(replace(pattern, when=_rooted(pattern.when, sides.root)) for pattern in patterns)
    operation = replace(operation, patterns=patterns)
    operation = replace(
        operation,
        arguments=() if described and described[0][0] else operation.arguments,
        command=_is_command(table, operation),
        current=table.current,
        opposite=table.opposite,
        refusals=tuple(table.refusals),
        idle=schema.read_idle(place / "idle", table.idle),
        refused=_read_refused(place / "refused", table.refused, operation.named),
        message=_read_message(place, table, sides.root, operation),
        signature=table.signature,
        overrides=table.overrides,
    )
    if table.when is None:
        return operation
    return in_cases(operation, _rooted(read_when(place / "when", table.when), sides.root))


def _read_result(
    place: DocumentPlace, table: OperationTable, form: Form | None, sides: Sides
) -> tuple[Quantity, ...]:
    if sides.read is None:
        return ()
    raw = getattr(table, sides.read)
    if form is Form.PARAMETER and raw is None:
        return (Quantity(sides.read, Path(), Kind.SETTING),)
    return read_quantities(place / sides.read, raw, sides)


def _is_command(table: OperationTable, operation: Operation) -> bool:
    """Return whether the call is a command, unless the vocabulary specifies it."""
    form = operation.named.form if operation.named is not None else None
    patterns, result = operation.patterns, operation.result
    if form is not None and form not in _COMMANDS:
        return False
    if table.command is not None:
        return table.command
    if form not in (None, Form.CALL) or operation.arguments or any(pattern.arguments for pattern in patterns):
        return True
    if patterns and form is None:
        return not result and any(not pattern.result for pattern in patterns)
    return bool(patterns) or not result


def _read_message(
    place: DocumentPlace, table: OperationTable, root: str | None, operation: Operation
) -> str | None:
    """Return the path to the command's name in a call; None if there is none or a mistake, which is noted."""
    what = "argument" if root is None else "field"
    if table.message is None:
        if table.patterns:
            (place / "patterns").error(f'needs message = "…": the {what} that holds the command')
        return None
    try:
        path = Path.parse(table.message, rooted=True)
    except ValueError:
        (place / "message").error(
            f"{table.message!r} is not the name of {'an' if root is None else 'a'} {what}"
        )
        return None
    path = path if root is None else in_message(path, root)
    patterns = (argument for pattern in operation.patterns for argument in pattern.arguments)
    if any(argument.path == path for argument in (*operation.arguments, *patterns)):
        where = place / "arguments" / table.message
        where.error("holds the text command, which patterns describe")
    return str(path) if root is not None else table.message


def _rooted(cases: tuple[Case, ...], root: str | None) -> tuple[Case, ...]:
    """Return the cases with paths into a message that is written."""
    if root is None:
        return cases
    return tuple(replace(case, argument=str(in_message(bare_path(case.argument), root))) for case in cases)


def _check_from_self(place: DocumentPlace, operation: Operation) -> None:
    """Note texts of commands that read the object itself, which is no argument of the call."""
    if operation.message is None or Path.parse(operation.message, rooted=True).root != "self":
        return
    for index, pattern in enumerate(operation.patterns):
        fields = [quantity.name for quantity in pattern.arguments if quantity.name in pattern.fields]
        what = f"{{{fields[0]}}}" if fields else "an opposite" if pattern.opposite is not None else None
        if what is not None:
            (place / index).error(
                f"the text comes from {operation.message}, which no call gives, so {what} cannot be "
                "sent in its place; describe the arguments of the call beside it"
            )


def _check_signature(place: DocumentPlace, operation: Operation) -> None:
    at = place / "signature"
    if operation.signature is None:
        if operation.kind == "methods" and operation.described:
            names = ", ".join(operation.described)
            at.error(
                "is needed where only the method is named: its arguments have no names; "
                f'write signature = "({names}, …)", all in their order'
            )
        return
    signature = at.attempt(parse_signature, operation.signature)
    if signature is None or any(
        parameter.kind is parameter.VAR_KEYWORD for parameter in signature.parameters.values()
    ):
        return
    for name, key in operation.described.items():
        if name not in signature.parameters:
            where = place
            for part in key.split(".", 1):
                where /= part
            where.unknown("argument", name, signature.parameters)


def _read_refused(place: DocumentPlace, raw: Any, named: Named | None) -> tuple[Refused, ...]:
    """Read ``refused``: a table, a list of tables, or for an action also how its goal ends."""
    action = named.name if named is not None and named.form is Form.GOAL else None
    if raw is None:
        return ()
    if raw == []:
        place.error(f"must not be empty, {_REFUSED}")
    if action is not None and isinstance(raw, list) and all(isinstance(item, str) for item in raw):
        for at, word in place.each(raw):
            if word not in ENDINGS:
                at.unknown("end of a goal", word, ENDINGS)
        return (Refused("", tuple(raw), action),)
    found = []
    for at, item in place.each(raw):
        table = at.table(schema.RefusedTable, item)
        path = (at / "path").attempt(_path_in_answer, table.path) if table is not None else None
        if table is not None and path is not None:
            found.append(Refused(str(path), tuple(table.values), table.topic or action))
            if table.topic is None and named is not None and named.form is Form.PUBLISH:
                at.error('a published message has no answer; name the topic of the refusal: topic = "/…"')
    return tuple(found)


def _path_in_answer(text: str) -> Path:
    """Return the path into an answer or a message, which may begin without a dot. Raises ValueError."""
    if not text or text.startswith("["):
        return Path.parse(text, rooted=False)
    return in_message(bare_path(text), None)


def read_clock(place: DocumentPlace, raw: dict[str, Any]) -> Clock | None:
    """Read ``clock = { tick = …, time or step = …, unit = … }``; None if it has mistakes, which are noted."""
    table = place.table(schema.ClockTable, raw)
    if table is None:
        return None
    rooted = table.time != "" and not table.time.startswith((".", "["))
    (place / "time").attempt(Path.parse, table.time, rooted=rooted)
    if table.step is not None and "time" in raw:
        (place / "step").error("the time is either read (time) or counted (step), not both")
    return Clock(table.tick, table.time, rooted, table.unit, place.source("clock"), table.step)


def read_wait(place: DocumentPlace, raw: dict[str, Any]) -> Wait | None:
    """Read ``wait = { call = …, unit = … }``; None if it has mistakes, which are noted."""
    table = place.table(schema.WaitTable, raw)
    return Wait(table.call, table.unit, place.source("wait")) if table is not None else None


def read_probe(place: DocumentPlace, raw: Any) -> Probe | None:
    """Read one ``[[probe]]``; None if it has mistakes, which are noted."""
    table = place.table(schema.ProbeTable, raw)
    if table is None:
        return None
    result = read_quantities(place / "result", table.result)
    return Probe(table.call, table.tolerance, place.source(table.call), result)
