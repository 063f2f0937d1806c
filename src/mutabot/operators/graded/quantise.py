"""quantise: a value goes in steps."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.operators._evidence import SENSORS
from mutabot.operators.graded._ladders import Ladder, own_ladder
from mutabot.operators.graded._shape import GradedOperator, Passed
from mutabot.operators.operator import Example, Subject

_Y = Quantity("dy", Path("dy"), Kind.TRANSLATION, "y", "m", "base", Mode.BY)
_X = Quantity(".x", Path.parse(".x", rooted=False), Kind.POSITION, "x", "m", "world")
_MOVE = Operation("robot:Arm.move_by", (_Y,))
_LOCATE = Operation("camera:locate", result=(_X,), command=False)


class Quantise(GradedOperator):
    """Rounds to the nearest multiple of the step."""

    name = "quantise"
    summary = (
        "A commanded or read value is rounded to the nearest multiple of a step, as by a coarse encoder or"
        " converter."
    )
    where = "every number that is commanded or read, bar orientations as a whole"
    stands_for = f"A coarse encoder or converter: {SENSORS}."
    rank = 240
    directions = ("",)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_MOVE, None, _Y, "50mm", 50.0, "mm"), {"dy": 0.23}, performed=({"dy": 0.25},)),
        Example(
            Subject(_LOCATE, None, _X, "20mm", 20.0, "mm"),
            replied={".x": 0.55},
            performed=({},),
            received={".x": 0.56},
        ),
        Example(
            Subject(_MOVE, None, _Y, "50mm", 50.0, "mm"), {"dy": 0.2}, away="it is a multiple of the step"
        ),
    )

    def ladder(self, quantity: Quantity, *, written: bool) -> Ladder | None:
        return None if quantity.is_whole or quantity.kind is Kind.COUNT else own_ladder(quantity)

    def number(self, size: float, value: float, passed: Passed) -> float:
        return round(value / size) * size if size else value

    def fault(self, subject: Subject) -> str:
        return f"in steps of {subject.magnitude:g}{f' {subject.unit}' if subject.unit else ''}"
