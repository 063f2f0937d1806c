"""Tables of a vocabulary turned into operations, clock and probes."""

from __future__ import annotations

from typing import Any

from mutabot.errors import nearest_name
from mutabot.model import ANY, Case, Clock, Operation, Path, Pattern, Probe, Quantity, Wait
from mutabot.model.signature import parse_signature
from mutabot.model.units import UNITS, Dimension, dimension_of
from mutabot.settings.mistakes import Check, shown
from mutabot.settings.toml_lines import KeyPath
from mutabot.vocabulary.cases.when import Undecided, in_cases

from .cases.when import in_case, read_when
from .named import NAMING, is_named, read_current, read_named, read_refused
from .patterns import read_patterns
from .quantities import read_arguments, read_result
from .schema import ClockTable, OperationTable, ProbeTable, WaitTable, is_name, read_idle, target_fault


def read_operations(check: Check, raw: Any, place: KeyPath) -> list[Operation]:
    """One ``[[operation]]``: an operation, or all that is done under a name. Mistakes are noted."""
    if is_named(raw):
        return read_named(check, raw, place)
    _check_one_name(check, raw, place)
    operation = read_operation(check, with_target(check, raw, place), place)
    return [operation] if operation is not None else []


def read_operation(check: Check, raw: Any, place: KeyPath) -> Operation | None:
    """One ``[[operation]]``; None if not even its call can be told. Mistakes are noted."""
    table = check.table(OperationTable, raw, place, salvage=True)
    if table is None:
        return None
    if table.method is None:
        check_target(check, table.call, (*place, "call"))
    check_targets(check, table.refusals, (*place, "refusals"))
    source = check.source(place, table.call)
    arguments = read_arguments(check, table.arguments, (*place, "arguments"))
    result = read_result(check, table.result, (*place, "result"))
    patterns = read_patterns(check, table.patterns, (*place, "patterns"), source, arguments)
    message = _read_message(check, table, (arguments, *(one.arguments for one in patterns)), place)
    if table.message is None and not table.patterns:
        arguments, patterns = in_cases(check, arguments, result, table.opposite, source, place)
    if table.overrides and "." not in table.call.partition(":")[2]:
        check.error((*place, "overrides"), f"{table.call} is no method of a class, so nothing overrides it")
    operation = Operation(
        target=table.call,
        arguments=tuple(one for one in arguments if not isinstance(one, Undecided)),
        result=result,
        command=_is_command(table, arguments, result, patterns),
        current=read_current(check, table.current, (*place, "current")),
        opposite=table.opposite,
        refusals=tuple(table.refusals),
        message=message,
        patterns=patterns,
        source=source,
        signature=table.signature,
        overrides=table.overrides,
        idle=read_idle(check, table.idle, (*place, "idle")),
        refused=read_refused(check, table.refused, (*place, "refused")),
        kind="methods" if table.method is not None else None,
    )
    _check_from_self(check, operation, place)
    if not (table.arguments or table.result or table.message or operation.command):
        check.error(place, "says nothing: no arguments, no result, no patterns, and command = false")
    if table.when is not None:
        cases = read_when(check, table.when, (*place, "when"))
        _check_self(check, table, cases, place)
        operation = in_case(operation, cases)
    _check_signature(check, operation, place)
    return operation


def with_target(check: Check, raw: Any, place: KeyPath) -> Any:
    """An entry that names a method, whatever object has it, with the target that stands for that."""
    if not isinstance(raw, dict) or "method" not in raw:
        return raw
    if "call" in raw:
        check.error((*place, "method"), "an operation is known by one thing: either call or method")
        return raw
    if raw.get("overrides"):
        check.error((*place, "overrides"), "is of no use here: a method counts for every class")
    made = dict(raw)
    for key in ("method", "current", "opposite"):
        name = raw.get(key)
        if key == "method" and not (isinstance(name, str) and is_name(name)):
            check.error((*place, key), f"{shown(name)} is not the name of a method, such as move_by")
        elif isinstance(name, str) and is_name(name):
            made["call" if key == "method" else key] = f"{ANY}.{name}"
    return made


#: words that people use for names on a middleware
_OTHER_WORDS = {
    "transform": "tf", "frame": "tf", "param": "parameter", "publisher": "topic", "subscriber": "topic",
    "srv": "service",
}  # fmt: skip


def _check_one_name(check: Check, raw: Any, place: KeyPath) -> None:
    """Note a callable that is to have a name on a middleware as well, and a misspelt key for such a name."""
    if not isinstance(raw, dict):
        return
    for key in NAMING:
        if key in raw:
            check.error((*place, key), f"an operation is known by one thing: either call or {key}")
    if "call" not in raw and "method" not in raw:
        for key in raw:
            near = None if key in OperationTable.model_fields else nearest_name(key, ("call", *NAMING))
            if near in NAMING:
                check.unknown((*place, key), "key", key, NAMING)
            elif key in _OTHER_WORDS:
                check.error((*place, key), f"unknown key; did you mean {_OTHER_WORDS[key]}?")


def read_clock(check: Check, raw: dict[str, Any], place: KeyPath) -> Clock | None:
    """``clock = { tick = …, time or step = …, unit = … }``; None if it has mistakes, which are noted."""
    table = check.table(ClockTable, raw, place)
    if table is None:
        return None
    check_target(check, table.tick, (*place, "tick"))
    _check_time(check, table.unit, (*place, "unit"))
    rooted = table.time != "" and not table.time.startswith((".", "["))
    try:
        Path.parse(table.time, rooted=rooted)
    except ValueError as error:
        check.error((*place, "time"), str(error))
    if table.step is not None and "time" in raw:
        check.error((*place, "step"), "the time is either read (time) or counted (step), not both")
    return Clock(table.tick, table.time, rooted, table.unit, check.source(place, "clock"), table.step)


def read_wait(check: Check, raw: dict[str, Any], place: KeyPath) -> Wait | None:
    """``wait = { call = …, unit = … }``; None if it has mistakes, which are noted."""
    table = check.table(WaitTable, raw, place)
    if table is None:
        return None
    check_target(check, table.call, (*place, "call"))
    _check_time(check, table.unit, (*place, "unit"))
    return Wait(table.call, table.unit, check.source(place, "wait"))


def _check_time(check: Check, unit: str, place: KeyPath) -> None:
    times = [name for name in UNITS if dimension_of(name) is Dimension.TIME]
    if unit not in times:
        check.unknown(place, "unit", unit, times)


def read_probe(check: Check, raw: Any, place: KeyPath) -> Probe | None:
    """One ``[[probe]]``; None if it has mistakes, which are noted."""
    table = check.table(ProbeTable, raw, place)
    if table is None:
        return None
    check_target(check, table.call, (*place, "call"))
    result = read_result(check, table.result, (*place, "result"))
    return Probe(table.call, table.tolerance, check.source(place, table.call), result, table.better)


def check_targets(check: Check, targets: list[str], place: KeyPath) -> None:
    """Note each target that is not ``module:qualified.name``."""
    for index, target in enumerate(targets):
        check_target(check, target, (*place, index))


def check_target(check: Check, target: str, place: KeyPath) -> None:
    """Note a target that is not ``module:qualified.name``."""
    fault = target_fault(target)
    if fault is not None:
        check.error(place, fault)


def _read_message(
    check: Check, table: OperationTable, described: tuple[tuple[Quantity, ...], ...], place: KeyPath
) -> str | None:
    """The path to what says which command a call is; None if there is none, or a mistake, which is noted."""
    if table.patterns and table.message is None:
        check.error((*place, "patterns"), 'needs message = "…": the argument that holds the command')
    if table.message is None:
        return None
    try:
        path = Path.parse(table.message, rooted=True)
    except ValueError:
        check.error((*place, "message"), f"{table.message!r} is not the name of an argument")
        return None
    if path.root == "self" and "." not in table.call.partition(":")[2]:
        check.error((*place, "message"), f"{table.call} is no method of a class, so it has no self")
    for quantity in (one for several in described for one in several):
        if quantity.path == path:
            where = (*place, "arguments", table.message)
            check.error(where, "holds the text command, which patterns describe")
            break
    return table.message


def _check_from_self(check: Check, operation: Operation, place: KeyPath) -> None:
    """What lies in the object tells which command it is, but cannot be said otherwise."""
    if operation.message is None or Path.parse(operation.message, rooted=True).root != "self":
        return
    for index, pattern in enumerate(operation.patterns):
        fields = [quantity.name for quantity in pattern.arguments if quantity.name in pattern.fields]
        what = f"{{{fields[0]}}}" if fields else "an opposite" if pattern.opposite is not None else None
        if what is not None:
            where = (*place, "patterns", index)
            check.error(
                where,
                f"the text comes from {operation.message}, which no call gives, so {what} cannot be "
                "sent in its place; describe the arguments of the call beside it",
            )


def _check_self(check: Check, table: OperationTable, cases: tuple[Case, ...], place: KeyPath) -> None:
    for case in cases:
        if Path.parse(case.argument, rooted=True).root == "self" and "." not in table.call.partition(":")[2]:
            check.error((*place, "when"), f"{table.call} is no method of a class, so it has no self")


def _check_signature(check: Check, operation: Operation, place: KeyPath) -> None:
    if operation.signature is None:
        if operation.kind == "methods" and operation.described:
            names = ", ".join(operation.described)
            text = "is needed where only the method is named: what it is called with tells no names"
            check.error(
                (*place, "signature"), f'{text}; write signature = "({names}, …)", all in their order'
            )
        return
    try:
        signature = parse_signature(operation.signature)
    except ValueError as error:
        check.error((*place, "signature"), str(error))
        return
    if any(one.kind is one.VAR_KEYWORD for one in signature.parameters.values()):
        return
    for name, key in operation.described.items():
        if name not in signature.parameters:
            check.unknown((*place, *key.split(".", 1)), "argument", name, signature.parameters)


def _is_command(
    table: OperationTable,
    arguments: tuple[Quantity, ...],
    result: tuple[Quantity, ...],
    patterns: tuple[Pattern, ...],
) -> bool:
    """Whether the robot does something, unless the vocabulary says so itself."""
    if table.command is not None:
        return table.command
    if arguments or any(pattern.arguments for pattern in patterns):
        return True
    if patterns:
        return not result and any(not pattern.result for pattern in patterns)
    return not result
