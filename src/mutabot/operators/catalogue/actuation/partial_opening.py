"""partial-opening: a gripper stops half way."""

from __future__ import annotations

from typing import Any, ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import COMMANDS
from mutabot.operators.catalogue._shape import ValueFault, like, middle_of
from mutabot.operators.operator import Example, Subject, map_numbers
from mutabot.operators.robot._values import quantity_of

_WIDTH = Quantity("width", Path("width"), Kind.OPENING, unit="mm", range=(0.0, 85.0))
_TWO = Quantity("position", Path("position"), Kind.OPENING, unit="fraction", values=(0, 1))
_MOVE = Operation("robot:Gripper.move", (_WIDTH,))


class PartialOpening(ValueFault):
    """Leaves half of the way from the end of the range that is farther off."""

    name = "partial-opening"
    summary = (
        "A gripper stops half way, as seen from the end of its range that is farther off: half open,"
        " half closed."
    )
    rank = 354
    stands_for = f"Commands that are not carried out in full, as by a gripper that jams: {COMMANDS}."
    where = "openings with a range or clip; those of two values take no other"
    of_read = False
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_MOVE, quantity=_WIDTH), {"width": 80.0}, performed=({"width": 40.0},)),
        Example(
            Subject(_MOVE, quantity=_WIDTH), {"width": 0.0}, performed=({"width": 42.5},), note="half closed"
        ),
        Example(Subject(_MOVE, quantity=_WIDTH), {}, away="the call says nothing of it"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        limits = quantity.range or quantity.clip
        return quantity.kind is Kind.OPENING and limits is not None and quantity.values is None

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        low, high = middle_of(quantity_of(subject), 1.0)

        def half(number: float) -> float:
            far = low if number - low >= high - number else high
            return like(number, (number + far) / 2.0)

        return map_numbers(value, half)
