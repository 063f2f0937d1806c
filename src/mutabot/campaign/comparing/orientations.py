"""Comparing orientations by the angle between them, and single angles modulo a full turn."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from mutabot.frozen import frozen
from mutabot.model import Operation, Path, Probe, Quantity
from mutabot.model.values.quantity import is_number
from mutabot.model.values.rotation import apart, distance

#: an operation and the notation of its command
Command = tuple[str, str | None]
_PARTS = (("w", "x", "y", "z"), ("x", "y", "z"))


@frozen
class Turned:
    """Two values of one orientation or angle.

    Attributes:
        name: the part of the probe.
        keys: the values it consists of.
        before, after: as they were read.
        angle: how far they are apart, in the quantity's unit (radians for a quaternion).
        unit: that unit.
    """

    name: str
    keys: tuple[str, ...]
    before: Any
    after: Any
    angle: float
    unit: str


class Angles:
    """The orientations and angles among the values of operations."""

    def __init__(self, operations: Sequence[Operation]) -> None:
        self._known: dict[Command, dict[str, Quantity]] = {}
        for operation in operations:
            self._add((operation.target, None), (*operation.arguments, *operation.result))
            for pattern in operation.patterns:
                self._add((operation.target, pattern.text), (*pattern.arguments, *pattern.result))

    def of(self, command: Command) -> Mapping[str, Quantity]:
        """Those of one command, by name."""
        return self._known.get(command, {})

    def _add(self, command: Command, quantities: Sequence[Quantity]) -> None:
        found = {one.name: one for one in quantities if one.is_whole or one.full_turn is not None}
        if found:
            self._known[command] = found


def angle_between(quantity: Quantity, before: Any, after: Any) -> float | None:
    """How far two values of a quantity are apart as orientations or angles; None if they are none."""
    if quantity.is_whole:
        first, second = quantity.orientation(before), quantity.orientation(after)
        return quantity.from_unit(distance(first, second), "rad") if first and second else None
    turn = quantity.full_turn
    if turn is None or not (is_number(before) and is_number(after)):
        return None
    return apart(before, after, turn)


def values_apart(
    before: Any, after: Any, quantities: Mapping[str, Quantity], other: Callable[[Any, Any], float]
) -> float:
    """The greatest distance of two sets of values by quantity; ``other`` is that of all other values."""
    if not quantities or not isinstance(before, Mapping) or not isinstance(after, Mapping):
        return other(before, after)
    distances = []
    for name in {*before, *after}:
        angle = None
        if name in quantities:
            angle = angle_between(quantities[name], before.get(name), after.get(name))
        distances.append(other(before.get(name), after.get(name)) if angle is None else angle)
    return max(distances, default=0.0)


def turned_parts(
    original: Mapping[str, Any], mutant: Mapping[str, Any], probes: Sequence[Probe]
) -> Iterator[Turned]:
    """The orientations and angles in two readings of the probes, as far as both have them."""
    for probe in probes:
        for name in readings_of(probe, original) if probe.result else ():
            for quantity in probe.result:
                keys = _keys(name, quantity, original)
                if not keys or not all(key in original and key in mutant for key in keys):
                    continue
                before, after = (_value(quantity, keys, values) for values in (original, mutant))
                angle = angle_between(quantity, before, after)
                if angle is not None:
                    yield Turned(f"{name}{quantity.path}", keys, before, after, angle, quantity.unit or "rad")


def _value(quantity: Quantity, keys: Sequence[str], values: Mapping[str, Any]) -> Any:
    return [values[key] for key in keys] if quantity.is_whole else values[keys[0]]


def parts_of(name: str, quantity: Quantity, values: Mapping[str, Any]) -> Iterator[Any]:
    """The value of a quantity in a reading of a probe, if it is there."""
    keys = _keys(name, quantity, values)
    if keys and all(key in values for key in keys):
        yield _value(quantity, keys, values)


def readings_of(probe: Probe, values: Mapping[str, Any]) -> list[str]:
    """The probe's names among its values: one for each object."""
    found: dict[str, None] = {}
    for key in values:
        tail = key[len(probe.target) :] if key.startswith(probe.target) else None
        if tail is not None and (not tail or tail[0] in ".[#"):
            number = tail[1:].partition(".")[0].partition("[")[0] if tail[:1] == "#" else ""
            found[f"{probe.target}#{number}" if number else probe.target] = None
    return list(found)


def _keys(name: str, quantity: Quantity, values: Mapping[str, Any]) -> tuple[str, ...]:
    """The flat values that a quantity consists of, in its order; none if they are not there."""
    path: Path = quantity.path
    bounds = path.steps[-1].bounds if path.steps else None
    steps = path.steps[:-1] if bounds is not None else path.steps
    base = name + "".join(
        _step(step.attribute if step.attribute is not None else step.item) for step in steps
    )
    if bounds is None and not quantity.is_whole:
        return (base,)
    count = 0
    while f"{base}[{count}]" in values:
        count += 1
    if count:
        indexes = range(count)[slice(*bounds)] if bounds is not None else range(count)
        return tuple(f"{base}[{index}]" for index in indexes)
    named: tuple[str, ...] = next(
        (parts for parts in _PARTS if all(f"{base}.{part}" in values for part in parts)), ()
    )
    if len(named) == 4 and quantity.order is not None:
        named = tuple(quantity.order)
    return tuple(f"{base}.{part}" for part in named)


def _step(item: Any) -> str:
    return f"[{item}]" if isinstance(item, int) else f".{item}"
