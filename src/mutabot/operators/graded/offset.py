"""offset: a value is off by a fixed amount."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.operators._evidence import PARAMETERS
from mutabot.operators.graded._ladders import Ladder, own_ladder
from mutabot.operators.graded._shape import GradedOperator, Passed
from mutabot.operators.operator import Example, Subject

_Y = Quantity("dy", Path("dy"), Kind.TRANSLATION, "y", "m", "base", Mode.BY)
_Z = Quantity("z", Path("z"), Kind.TRANSLATION, "z", "m", "base", Mode.TO, range=(0.0, 0.5))
_X = Quantity(".x", Path.parse(".x", rooted=False), Kind.POSITION, "x", "m", "world")
_TURN = Quantity("rotation", Path("rotation"), Kind.ROTATION_VECTOR, unit="deg")
_MOVE = Operation("robot:Arm.move_by", (_Y,))
_LIFT = Operation("robot:Arm.lift_to", (_Z,))
_LOCATE = Operation("camera:locate", result=(_X,), command=False)
_ORIENT = Operation("robot:Arm.orient", (_TURN,))
_20 = {"magnitude": 20.0, "unit": "mm"}


class Offset(GradedOperator):
    """Adds a fixed amount, or takes it away."""

    name = "offset"
    summary = "A commanded or read value is off by a fixed amount, at every call, in one direction."
    where = "every number that is commanded or read, bar waits"
    stands_for = f"A tool, a fixture or a camera that stands off, or a wrong constant: {PARAMETERS}."
    rank = 200
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MOVE, None, _Y, "+20mm", 20.0, "mm", "+"),
            {"dy": 0.2},
            performed=({"dy": 0.22},),
            note="the box is put down 20 mm too far",
        ),
        Example(
            Subject(_LOCATE, None, _X, "-5mm", 5.0, "mm", "-"),
            replied={".x": 0.55},
            performed=({},),
            received={".x": 0.545},
            note="the camera was bumped into",
        ),
        Example(
            Subject(_ORIENT, None, _TURN, "z+20deg", 20.0, "deg", "z+"),
            {"rotation": [0.0, 0.0, 30.0]},
            performed=({"rotation": [0.0, 0.0, 50.0]},),
            note="an orientation as a whole is turned further, about one axis of its frame",
        ),
        Example(
            Subject(_LIFT, None, _Z, "+100mm", 100.0, "mm", "+"),
            {"z": 0.45},
            away="0.55 m is outside the range [0, 0.5]",
        ),
    )

    def ladder(self, quantity: Quantity, *, written: bool) -> Ladder | None:
        return None if quantity.kind is Kind.DURATION else own_ladder(quantity)

    def number(self, size: float, value: float, passed: Passed) -> float:
        return value + size
