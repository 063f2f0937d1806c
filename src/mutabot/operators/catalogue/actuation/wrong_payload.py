"""wrong-payload: the mass at the tool is set wrongly."""

from __future__ import annotations

from typing import Any, ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import PARAMETERS
from mutabot.operators.catalogue._shape import ValueFault, like
from mutabot.operators.operator import Example, Subject, map_numbers

_FACTORS = {"none": 0.0, "double": 2.0}
_M = Quantity("mass", Path("mass"), Kind.MASS, unit="kg", range=(0.0, 5.0))
_SET = Operation("robot:Arm.set_payload", (_M,))


class WrongPayload(ValueFault):
    """Sets no payload, or twice as much."""

    name = "wrong-payload"
    summary = "The payload that is set is none, or twice as heavy as it is."
    rank = 353
    stands_for = f"A wrong parameter: {PARAMETERS}."
    where = "written quantities of kind mass"
    of_read = False
    variants = tuple(_FACTORS)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_SET, quantity=_M, variant="none"), {"mass": 1.2}, performed=({"mass": 0.0},)),
        Example(Subject(_SET, quantity=_M, variant="double"), {"mass": 1.2}, performed=({"mass": 2.4},)),
        Example(
            Subject(_SET, quantity=_M, variant="double"), {"mass": 4.0}, away="the robot takes 5 kg at most"
        ),
        Example(Subject(_SET, quantity=_M, variant="none"), {"mass": 0.0}, away="there is none to forget"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind is Kind.MASS

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        factor = _FACTORS[subject.variant]
        return map_numbers(value, lambda number: like(number, factor * number))
