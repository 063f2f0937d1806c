"""quaternion-order: a quaternion's scalar part is taken to be at the other end."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.operators._evidence import FRAMES
from mutabot.operators.operator import Example, Subject
from mutabot.operators.robot._values import quantity_of

from ._whole import OtherReading

_TURNED = Quantity("turned", Path("turned"), Kind.QUATERNION, order="wxyz")
_SEEN = Quantity("result", Path(), Kind.QUATERNION, order="xyzw")
_ORIENT = Operation("robot:Arm.orient", (_TURNED,))
_LOOK = Operation("camera:orientation", result=(_SEEN,), command=False)


class QuaternionOrder(OtherReading):
    """Takes xyzw for wxyz, and the other way round."""

    name = "quaternion-order"
    summary = "A quaternion is taken to have its scalar part at the other end: xyzw for wxyz, and back."
    rank = 321
    stands_for = f"Libraries that order quaternions in two ways: {FRAMES}."
    where = "written and read quantities of kind quaternion"
    kind = Kind.QUATERNION
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_ORIENT, quantity=_TURNED),
            {"turned": [0.8, 0.6, 0.0, 0.0]},
            performed=({"turned": [0.0, 0.8, 0.6, 0.0]},),
            note="0.8 is taken for x",
        ),
        Example(
            Subject(_LOOK, quantity=_SEEN),
            replied={"result": [0.0, 0.0, 0.6, 0.8]},
            performed=({},),
            received={"result": [0.0, 0.6, 0.8, 0.0]},
        ),
        Example(
            Subject(_ORIENT, quantity=_TURNED),
            {"turned": [0.5, 0.5, 0.5, 0.5]},
            away="all parts are the same, so their order is none",
        ),
    )

    def numbers(self, subject: Subject, numbers: list[float]) -> list[float]:
        is_scalar_first = quantity_of(subject).order != "xyzw"
        return [numbers[-1], *numbers[:-1]] if is_scalar_first else [*numbers[1:], numbers[0]]
