"""The shape of operators that scale what is commanded, within its range."""

from __future__ import annotations

from typing import Any, ClassVar

from mutabot.model import Kind, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators.catalogue._shape import ValueFault, like, within
from mutabot.operators.operator import Subject, map_numbers
from mutabot.operators.robot._values import quantity_of

#: factors by how variants call them
FACTORS = {"x0.3": 0.3, "x0.5": 0.5, "x2": 2.0}


class Override(ValueFault):
    """Scales a commanded number; what leaves its range stays at the end of it.

    Class attributes:
        kinds: the kinds of quantities on which it acts.
        factors: by variant.
    """

    of_read = False
    kinds: ClassVar[frozenset[Kind]]
    variants: ClassVar[tuple[str, ...]] = ("x0.5", "x2")

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind in self.kinds

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        limits = quantity_of(subject).range
        factor = self.factor(subject)
        return map_numbers(value, lambda number: like(number, within(factor * number, limits)))

    def factor(self, subject: Subject) -> float:
        """By how much."""
        return FACTORS[subject.variant]
