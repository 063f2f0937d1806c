"""Tables of a vocabulary turned into operations, clock and probes."""

from __future__ import annotations

from typing import Any

from mutabot.model import Clock, Operation, Path, Pattern, Probe, Quantity
from mutabot.model.signature import parse_signature
from mutabot.model.units import UNITS, Dimension, dimension_of

from .explain import Check
from .idle import read_idle
from .lines import Place
from .patterns import read_patterns
from .quantities import read_arguments, read_result
from .schema import ClockTable, OperationTable, ProbeTable
from .targets import target_fault


def read_operation(check: Check, raw: Any, place: Place) -> Operation | None:
    """One ``[[operation]]``; None if not even its call can be told. Mistakes are noted."""
    table = check.table(OperationTable, raw, place, salvage=True)
    if table is None:
        return None
    check_target(check, table.call, (*place, "call"))
    check_targets(check, table.refusals, (*place, "refusals"))
    source = source_of(check, place, table.call)
    arguments = read_arguments(check, table.arguments, (*place, "arguments"))
    result = read_result(check, table.result, (*place, "result"))
    patterns = read_patterns(check, table.patterns, (*place, "patterns"), source)
    _check_message(check, table, arguments, place)
    _check_signature(check, table, arguments, place)
    if table.overrides and "." not in table.call.partition(":")[2]:
        check.error((*place, "overrides"), f"{table.call} is no method of a class, so nothing overrides it")
    operation = Operation(
        target=table.call,
        arguments=arguments,
        result=result,
        command=_is_command(table, arguments, result, patterns),
        current=table.current,
        opposite=table.opposite,
        refusals=tuple(table.refusals),
        message=table.message,
        patterns=patterns,
        source=source,
        signature=table.signature,
        overrides=table.overrides,
        idle=read_idle(check, table.idle, (*place, "idle")),
    )
    if not (table.arguments or table.result or table.message or operation.command):
        check.error(place, "says nothing: no arguments, no result, no patterns, and command = false")
    return operation


def read_clock(check: Check, raw: dict[str, Any], place: Place) -> Clock | None:
    """``clock = { tick = …, time or step = …, unit = … }``; None if it has mistakes, which are noted."""
    table = check.table(ClockTable, raw, place)
    if table is None:
        return None
    check_target(check, table.tick, (*place, "tick"))
    times = [unit for unit in UNITS if dimension_of(unit) is Dimension.TIME]
    if table.unit not in times:
        check.unknown((*place, "unit"), "unit", table.unit, times)
    rooted = table.time != "" and not table.time.startswith((".", "["))
    try:
        Path.parse(table.time, rooted=rooted)
    except ValueError as error:
        check.error((*place, "time"), str(error))
    if table.step is not None and "time" in raw:
        check.error((*place, "step"), "the time is either read (time) or counted (step), not both")
    return Clock(table.tick, table.time, rooted, table.unit, source_of(check, place, "clock"), table.step)


def read_probe(check: Check, raw: Any, place: Place) -> Probe | None:
    """One ``[[probe]]``; None if it has mistakes, which are noted."""
    table = check.table(ProbeTable, raw, place)
    if table is None:
        return None
    check_target(check, table.call, (*place, "call"))
    return Probe(table.call, table.tolerance, source_of(check, place, table.call))


def check_targets(check: Check, targets: list[str], place: Place) -> None:
    """Note each target that is not ``module:qualified.name``."""
    for index, target in enumerate(targets):
        check_target(check, target, (*place, index))


def check_target(check: Check, target: str, place: Place) -> None:
    """Note a target that is not ``module:qualified.name``."""
    fault = target_fault(target)
    if fault is not None:
        check.error(place, fault)


def source_of(check: Check, place: Place, name: str) -> str:
    """``robot.toml:12 · robot:Arm.move_by``"""
    line = check.document.line(place)
    return f"{check.document.file}{f':{line}' if line is not None else ''} · {name}"


def _check_message(
    check: Check, table: OperationTable, arguments: tuple[Quantity, ...], place: Place
) -> None:
    if table.patterns and table.message is None:
        check.error((*place, "patterns"), 'needs message = "…": the argument that holds the command')
    if table.message is None:
        return
    if not table.message.isidentifier():
        check.error((*place, "message"), f"{table.message!r} is not the name of an argument")
    if any(quantity.path.root == table.message for quantity in arguments):
        where = (*place, "arguments", table.message)
        check.error(where, "holds the text command, which patterns describe")


def _check_signature(
    check: Check, table: OperationTable, arguments: tuple[Quantity, ...], place: Place
) -> None:
    if table.signature is None:
        return
    try:
        signature = parse_signature(table.signature)
    except ValueError as error:
        check.error((*place, "signature"), str(error))
        return
    if any(one.kind is one.VAR_KEYWORD for one in signature.parameters.values()):
        return
    for quantity in arguments:
        if quantity.path.root not in signature.parameters:
            name = quantity.path.root or ""
            check.unknown((*place, "arguments", name), "argument", name, signature.parameters)
    if table.message is not None and table.message not in signature.parameters:
        check.unknown((*place, "message"), "argument", table.message, signature.parameters)


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
