"""quaternion-sign: one part of a quaternion has the wrong sign."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.operators._evidence import SIGNS
from mutabot.operators.operator import Example, Subject
from mutabot.operators.robot._values import quantity_of

from ._whole import OtherReading

_TURNED = Quantity("turned", Path("turned"), Kind.QUATERNION, order="wxyz")
_ORIENT = Operation("robot:Arm.orient", (_TURNED,))


class QuaternionSign(OtherReading):
    """Negates one part of a quaternion's vector; negating the scalar part is the inverse rotation."""

    name = "quaternion-sign"
    summary = (
        "One part of a quaternion's vector has the wrong sign; the inverse rotation is another operator's."
    )
    rank = 322
    stands_for = f"A wrong sign: {SIGNS}."
    where = "written and read quantities of kind quaternion"
    kind = Kind.QUATERNION
    variants = ("x", "y", "z")
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_ORIENT, quantity=_TURNED, variant="y"),
            {"turned": [0.8, 0.48, 0.36, 0.0]},
            performed=({"turned": [0.8, 0.48, -0.36, 0.0]},),
        ),
        Example(
            Subject(_ORIENT, quantity=_TURNED, variant="x"),
            {"turned": [0.0, 1.0, 0.0, 0.0]},
            away="half a turn the other way is the same orientation",
        ),
        Example(
            Subject(_ORIENT, quantity=_TURNED, variant="z"),
            {"turned": [0.8, 0.48, 0.36, 0.0]},
            away="a zero has no sign",
        ),
    )

    def numbers(self, subject: Subject, numbers: list[float]) -> list[float]:
        order = quantity_of(subject).order or "wxyz"
        return [
            -number if part == subject.variant else number
            for part, number in zip(order, numbers, strict=True)
        ]
