"""The rules of a guard: why a call must not reach the robot, and how close it comes to a limit.

All rules look at the values that would go out. A relative move counts by its target: where the robot is, as
the vocabulary's reading says, and the amount. What is not a finite number is within no limit.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from math import inf, isfinite, isnan
from typing import Any

from mutabot.api.values import Call, Operation, Quantity

from .tables import BoxTable, LimitTable, OrderTable
from .targets import UnreadableTarget, target_now, target_of

#: kinds whose axes x, y and z say where a target lies
_PLACES = ("translation",)


@dataclass(frozen=True, slots=True)
class RuleFinding:
    """The result of a rule for a call.

    Attributes:
        margin: how far the call is within the limit, in ``unit``; negative beyond it.
        unit: of the margin.
        text: what is compared with what, such as ``x 0.912 m, at most 0.8 m``.
    """

    margin: float
    unit: str
    text: str

    @property
    def is_within(self) -> bool:
        """Whether the call may pass; not if the margin is NaN."""
        return self.margin >= 0


def fits(call: Call, operations: Iterable[str]) -> bool:
    """Return whether a call is of one of these operations."""
    return is_among(call.operation, operations)


def is_among(operation: Operation, operations: Iterable[str]) -> bool:
    """Return whether an operation is one of these."""
    return any(fnmatchcase(operation.target, pattern) for pattern in operations)


def described(operation: Operation) -> Iterator[Quantity]:
    """Yield everything that the vocabulary describes of what an operation writes."""
    yield from operation.arguments
    for pattern in operation.patterns:
        yield from pattern.arguments


def written(call: Call) -> Iterator[tuple[Quantity, Any]]:
    """Yield the quantities that a call writes, with their values."""
    meant = call.pattern or call.operation
    for quantity in meant.arguments:
        if quantity.name in call.values:
            yield quantity, call.values[quantity.name]


@dataclass(frozen=True, slots=True)
class LimitRule:
    """The limits of a quantity."""

    table: LimitTable

    def concerns(self, operation: Operation) -> bool:
        """Return whether the rule limits a quantity of an operation."""
        return is_among(operation, self.table.operations) and any(map(self._is_meant, described(operation)))

    def of(self, call: Call, tool: str | None) -> Iterator[RuleFinding]:
        """Yield the results for a call. Raises UnreadableTarget."""
        table = self.table
        if not fits(call, table.operations) or not _applies(table.tool, tool):
            return
        for quantity, value in written(call):
            if self._is_meant(quantity):
                yield self._compared(quantity, target_of(call, quantity, value))

    def _is_meant(self, quantity: Quantity) -> bool:
        table = self.table
        is_kind = table.kind is None or quantity.kind == table.kind
        is_axis = table.axis is None or quantity.axis == table.axis
        return fnmatchcase(quantity.name, table.quantity) and is_kind and is_axis

    def _compared(self, quantity: Quantity, number: float) -> RuleFinding:
        table, unit = self.table, self.table.unit or quantity.unit or ""
        number = quantity.to_unit(number, unit) if unit else number
        above = number - table.min - table.margin if table.min is not None else inf
        below = table.max - table.margin - number if table.max is not None else inf
        ends = (("at least", table.min), ("at most", table.max))
        which = " and ".join(f"{relation} {end:g} {unit}" for relation, end in ends if end is not None)
        if table.margin:
            which += f", with a margin of {table.margin:g} {unit}"
        return RuleFinding(
            _least(above, below), unit, f"{quantity.name} {number:g} {unit}, allowed is {which}"
        )


@dataclass(frozen=True, slots=True)
class BoxRule:
    """A workspace, or an obstacle in it."""

    table: BoxTable

    def concerns(self, operation: Operation) -> bool:
        """Return whether the rule concerns a target of an operation."""
        return is_among(operation, self.table.operations) and any(map(self._is_place, described(operation)))

    def of(self, call: Call, tool: str | None) -> Iterator[RuleFinding]:
        """Yield the results for a call. Raises UnreadableTarget."""
        table = self.table
        if not fits(call, table.operations) or not _applies(table.tool, tool):
            return
        places = [
            argument for argument in (call.pattern or call.operation).arguments if self._is_place(argument)
        ]
        moved = [place for place in places if place.name in call.values]
        if table.keep == "in":
            yield from (
                self._inside(quantity, target_of(call, quantity, call.values[quantity.name]))
                for quantity in moved
            )
        elif moved:
            yield self._outside({place.axis or "": self._target(call, place) for place in places})

    def _is_place(self, quantity: Quantity) -> bool:
        return quantity.kind in _PLACES and quantity.axis in self.table.sides and self._is_frame(quantity)

    def _target(self, call: Call, quantity: Quantity) -> float:
        """Return the target along an axis, m or in the box's unit; without one, the robot's position."""
        value = call.values.get(quantity.name)
        target = target_now(call, quantity) if value is None else target_of(call, quantity, value)
        return quantity.to_unit(target, self.table.unit)

    def _is_frame(self, quantity: Quantity) -> bool:
        return self.table.frame is None or quantity.frame is None or quantity.frame == self.table.frame

    def _inside(self, quantity: Quantity, number: float) -> RuleFinding:
        """Return how far a target is inside the workspace along one axis."""
        unit, (least, greatest) = self.table.unit, self.table.sides[quantity.axis or ""]
        target, margin = quantity.to_unit(number, self.table.unit), self.table.margin
        text = (
            f"{quantity.name} leads to {target:g} {unit}, the workspace is {least:g} to {greatest:g} {unit}"
        )
        return RuleFinding(_least(target - least - margin, greatest - margin - target), unit, text)

    def _outside(self, targets: Mapping[str, float]) -> RuleFinding:
        """Return how far a target is outside an obstacle, along the axis with the largest distance."""
        table = self.table
        missing = ", ".join(sorted(table.sides.keys() - targets.keys()))
        if missing:
            raise UnreadableTarget(f"it says nothing of {missing}, so that a box to avoid cannot be compared")
        away = {
            axis: max(least - table.margin - targets[axis], targets[axis] - greatest - table.margin)
            for axis, (least, greatest) in table.sides.items()
        }
        margin = max(away.values()) if all(map(isfinite, targets.values())) else -inf
        place = ", ".join(f"{axis} {target:g} {table.unit}" for axis, target in targets.items())
        return RuleFinding(margin, table.unit, f"{place} lies in a box to avoid")


@dataclass(slots=True)
class OrderRule:
    """A required order of commands; it remembers the commands of the running test."""

    table: OrderTable
    is_open: bool = False

    def why_not(self, call: Call) -> str | None:
        """Return why the call comes too early; None if it does not."""
        if fits(call, self.table.operations) and not self.is_open:
            return f"is allowed only after {' or '.join(self.table.after)}"
        return None

    def note(self, call: Call) -> None:
        """Record a call that goes to the robot."""
        if fits(call, self.table.until):
            self.is_open = False
        if fits(call, self.table.after):
            self.is_open = True


def _applies(wanted: str | None, tool: str | None) -> bool:
    """Return whether a rule for one tool applies: also while it is unknown which one is mounted."""
    return wanted is None or tool is None or wanted == tool


def _least(above: float, below: float) -> float:
    """Return the smaller of two margins; NaN counts as beyond all limits."""
    return -inf if isnan(above) or isnan(below) else min(above, below)
