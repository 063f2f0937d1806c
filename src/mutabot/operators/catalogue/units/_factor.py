"""The shape of operators that take a number for another unit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar

from mutabot.model import Quantity
from mutabot.model.values.quantity import Value
from mutabot.model.values.units import convert
from mutabot.operators.catalogue._shape import ValueFault, like
from mutabot.operators.operator import Subject, map_numbers
from mutabot.operators.robot._values import quantity_of

#: the robot, or the program, takes the number as if it were in the other unit
TAKEN = "taken"
#: the number is worked out in the other unit, and nobody converts it
GIVEN = "given"


class OtherUnit(ValueFault):
    """Takes numbers for another unit.

    Class attributes:
        units: the other unit, by a quantity's own.
    """

    units: ClassVar[Mapping[str, str]]
    variants: ClassVar[tuple[str, ...]] = (TAKEN, GIVEN)
    where: ClassVar[str] = ""

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.unit in self.units

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        return (f"{variant}-{self.other(quantity)}" for variant in self.variants)

    def other(self, quantity: Quantity) -> str:
        """The other unit."""
        return self.units[quantity.unit or ""]

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        quantity = quantity_of(subject)
        own, other = quantity.unit or "", self.other(quantity)
        units = (other, own) if subject.variant.startswith(TAKEN) else (own, other)
        return map_numbers(value, lambda number: like(number, convert(number, *units)))

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        told = super().describe(subject, before, after)
        how = "taken for" if subject.variant.startswith(TAKEN) else "given in"
        return f"{told} ({how} {self.other(quantity_of(subject))})"


def both_ways(units: Mapping[str, str]) -> dict[str, str]:
    """The same units, and the other way round."""
    return {**units, **{other: one for one, other in units.items()}}
