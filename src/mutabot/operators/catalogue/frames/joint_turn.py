"""joint-turn: the target of a joint is off by a full turn."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import FRAMES
from mutabot.operators.catalogue._shape import ValueFault, like
from mutabot.operators.operator import Example, Subject, map_numbers
from mutabot.operators.robot._values import quantity_of

_SIGNS = {"+": 1.0, "-": -1.0}
_J6 = Quantity("joints[5]", Path("joints"), Kind.ROTATION, "j6", "deg", mode=Mode.TO, range=(-360.0, 360.0))
_MOVE = Operation("robot:Arm.move_joints", (_J6,))


class JointTurn(ValueFault):
    """Adds a full turn to the absolute angle of a joint, or takes one away."""

    name = "joint-turn"
    summary = "The target of a joint is off by a full turn: the tool ends alike, the way there does not."
    rank = 316
    stands_for = f"Angles that wrap around at ±180° or 360°: {FRAMES}."
    where = "absolute angles of joints: rotation with an axis j1 … and mode to"
    of_read = False
    variants = tuple(_SIGNS)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MOVE, quantity=_J6, variant="-"), {"joints[5]": 170}, performed=({"joints[5]": -190},)
        ),
        Example(
            Subject(_MOVE, quantity=_J6, variant="+"),
            {"joints[5]": 170},
            away="530° is out of the joint's range",
        ),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        is_joint = quantity.axis is not None and quantity.axis.startswith("j")
        return is_joint and quantity.kind is Kind.ROTATION and quantity.mode is Mode.TO

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        quantity = quantity_of(subject)
        turn = _SIGNS[subject.variant] * (
            360.0 if quantity.unit == "deg" else quantity.from_unit(2.0 * math.pi, "rad")
        )
        return map_numbers(value, lambda number: like(number, number + turn))
