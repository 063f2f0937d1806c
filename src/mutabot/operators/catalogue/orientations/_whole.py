"""The shape of operators that read the numbers of an orientation in another way."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

from mutabot.model import Kind, Quantity
from mutabot.model.values.quantity import Value
from mutabot.model.values.sameness import is_same
from mutabot.operators.catalogue._shape import Away, ValueFault
from mutabot.operators.operator import Subject, map_numbers
from mutabot.operators.robot._values import quantity_of


class OtherReading(ValueFault):
    """Puts other numbers in the place of those of an orientation.

    Class attributes:
        kind: of the orientations on which it acts.
    """

    kind: ClassVar[Kind]

    @abstractmethod
    def numbers(self, subject: Subject, numbers: list[float]) -> list[float]:
        """The other numbers."""

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind is self.kind

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        quantity = quantity_of(subject)
        if quantity.orientation(value) is None:
            raise Away("its value is no orientation")
        numbers = self.numbers(subject, [float(part) for part in value])
        if quantity.orientation(numbers) is None or is_same(quantity, value, numbers):
            raise Away("it would be the same orientation")
        parts = iter(numbers)
        return map_numbers(value, lambda _: next(parts) + 0.0)  # no −0
