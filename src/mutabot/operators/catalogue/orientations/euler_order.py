"""euler-order: three angles are carried out in the reverse order."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.rotation import from_euler
from mutabot.model.values.units import convert
from mutabot.operators._evidence import FRAMES
from mutabot.operators.operator import Example, Subject
from mutabot.operators.robot._values import quantity_of

from ._whole import OtherReading

_RPY = Quantity("rpy", Path("rpy"), Kind.EULER, unit="deg", order="xyz")
_ORIENT = Operation("robot:Arm.orient", (_RPY,))


class EulerOrder(OtherReading):
    """Takes angles about axes that stay for angles about axes that turn along, and the other way round."""

    name = "euler-order"
    summary = (
        "Euler angles are carried out in the reverse order: axes that stay are taken for axes that turn"
        " along."
    )
    rank = 320
    stands_for = f"Two conventions of Euler angles: {FRAMES}."
    where = "written and read quantities of kind euler"
    kind = Kind.EULER
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_ORIENT, quantity=_RPY),
            {"rpy": [45.0, 0.0, 90.0]},
            performed=({"rpy": [0.0, -45.0, 90.0]},),
        ),
        Example(
            Subject(_ORIENT, quantity=_RPY),
            {"rpy": [0.0, 0.0, 90.0]},
            away="a turn about one axis alone has no order",
        ),
    )

    def numbers(self, subject: Subject, numbers: list[float]) -> list[float]:
        quantity = quantity_of(subject)
        radians = [convert(angle, quantity.unit or "rad", "rad") for angle in numbers]
        return quantity.numbers(from_euler(radians, (quantity.order or "").swapcase()))
