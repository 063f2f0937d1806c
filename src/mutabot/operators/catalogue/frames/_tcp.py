"""The shape of operators that get the offset of the tool centre point wrong."""

from __future__ import annotations

from typing import Any, ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators.catalogue._shape import ValueFault
from mutabot.operators.operator import Subject, map_numbers
from mutabot.operators.robot._values import quantity_of

#: 12 cm of gripper that looks down
Z = Quantity("z", Path("z"), Kind.TRANSLATION, "z", "m", "base", Mode.TO, range=(0.0, 0.6), tcp=-0.12)
MOVE = Operation("robot:Arm.move_to", (Z,))


class WrongTcp(ValueFault):
    """Moves a target along the tool's offset.

    Class attributes:
        sign: which way, as a share of the offset.
    """

    of_read = False
    sign: ClassVar[float]

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return bool(quantity.tcp)

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        offset = self.sign * (quantity_of(subject).tcp or 0.0)
        return map_numbers(value, lambda number: number + offset)
