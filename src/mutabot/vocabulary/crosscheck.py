"""What operations say about each other, checked when all files are read."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from mutabot.model import Operation, Quantity
from mutabot.model.values.quantity import READING_OF, is_reading_of
from mutabot.settings.mistakes import Check
from mutabot.settings.toml_lines import KeyPath

#: an operation with the document and place it was read from
Read = tuple[Operation, Check, KeyPath]


def check_operations(entries: Iterable[Read], read: Mapping[str, Read]) -> None:
    """Note every ``current`` and ``opposite`` that names no fitting operation.

    Args:
        entries: what each entry says.
        read: what all entries together say of each target.
    """
    for operation, check, place in entries:
        for name in operation.currents:
            _check_current(operation, name, check, (*place, "current"), read)
        if not operation.currents and any(one.relative for one in _all_arguments(operation)):
            check.error(place, "relative = true needs current: what tells where the robot is")
        for name in operation.opposites:
            _check_opposite(operation, name, check, (*place, "opposite"), read)


def _check_current(
    operation: Operation, name: str, check: Check, place: KeyPath, read: Mapping[str, Read]
) -> None:
    if name not in read:
        check.unknown(place, "operation", name, read)
        return
    reading = read[name][0]
    if reading.command and reading.named is None:
        check.error(place, f"{name} is a command: asking it where the robot is would make the robot act")
        return
    moved = [quantity for quantity in _all_arguments(operation) if quantity.kind in READING_OF]
    if not moved:
        check.error(place, "is of no use here: no argument is a translation or a rotation")
        return
    readings = reading.readings
    if not any(is_reading_of(reading, written) for written in moved for reading in readings):
        missing = ", ".join(dict.fromkeys(_wanted(quantity) for quantity in moved))
        found = ", ".join(_described(reading) for reading in readings) or "nothing"
        check.error(place, f"{name} reads {found}, but here it would have to read {missing}")


def _check_opposite(
    operation: Operation, name: str, check: Check, place: KeyPath, read: Mapping[str, Read]
) -> None:
    if name == operation.target:
        check.error(place, "an operation cannot be its own opposite")
        return
    if name not in read:
        check.unknown(place, "operation", name, read)
        return
    mine, others = (_roots(each) for each in (operation, read[name][0]))
    if mine != others:
        odd = sorted(mine ^ others)[0]
        who = name if odd in others else operation.target
        check.error(place, f"an opposite has the same arguments, but only {who} has {odd!r}")


def _all_arguments(operation: Operation) -> list[Quantity]:
    return [*operation.arguments, *(q for pattern in operation.patterns for q in pattern.arguments)]


def _roots(operation: Operation) -> set[str]:
    quantities = operation.arguments if operation.message is not None else _all_arguments(operation)
    return {quantity.path.root for quantity in quantities if quantity.path.root is not None}


def _wanted(written: Quantity) -> str:
    kind = READING_OF[written.kind]
    return " ".join(part for part in (kind, written.axis, _in_frame(written)) if part)


def _described(reading: Quantity) -> str:
    return " ".join(part for part in (reading.kind, reading.axis, _in_frame(reading)) if part)


def _in_frame(quantity: Quantity) -> str:
    return f"in frame {quantity.frame!r}" if quantity.frame is not None else ""
