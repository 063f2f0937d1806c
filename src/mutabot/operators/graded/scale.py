"""scale: a value is a share too large or too small."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.model.values.units import Dimension, convert
from mutabot.operators._evidence import PARAMETERS
from mutabot.operators.graded._ladders import Ladder, ladder_in
from mutabot.operators.graded._shape import GradedOperator, Passed
from mutabot.operators.operator import Example, Subject

#: angles that say where something is: a share of them means nothing, as their zero is anywhere
_ANY_ZERO = frozenset({Kind.ORIENTATION, Kind.ANGLE, Kind.TEMPERATURE})
_Y = Quantity("dy", Path("dy"), Kind.TRANSLATION, "y", "m", "base", Mode.BY)
_GAP = Quantity("result", Path(), Kind.DISTANCE, unit="m")
_MOVE = Operation("robot:Arm.move_by", (_Y,))
_FEEL = Operation("sensor:gap", result=(_GAP,), command=False)


class Scale(GradedOperator):
    """Multiplies by 1 + ε, or by 1 − ε."""

    name = "scale"
    summary = (
        "A commanded or read value is a share too large (+) or too small (−), as after a wrong calibration."
    )
    where = "every number whose zero means nothing: amounts, positions, distances, no target angles"
    stands_for = f"A wrong gain or calibration factor: {PARAMETERS}."
    rank = 210
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_MOVE, None, _Y, "+5%", 5.0, "percent", "+"), {"dy": 0.2}, performed=({"dy": 0.21},)),
        Example(
            Subject(_FEEL, None, _GAP, "-10%", 10.0, "percent", "-"),
            replied={"result": 0.3},
            performed=({},),
            received={"result": 0.27},
            note="a sensor that was calibrated with another target",
        ),
        Example(
            Subject(_MOVE, None, _Y, "+5%", 5.0, "percent", "+"), {"dy": 0.0}, away="nothing is no share of"
        ),
    )

    def ladder(self, quantity: Quantity, *, written: bool) -> Ladder | None:
        is_target_angle = quantity.kind is Kind.ROTATION and quantity.mode is Mode.TO
        if quantity.is_whole or quantity.kind in _ANY_ZERO or is_target_angle:
            return None
        return ladder_in(quantity, Dimension.RATIO)

    def size_of(self, subject: Subject) -> float:
        share = convert(subject.magnitude or 0.0, subject.unit or "fraction", "fraction")
        return -share if subject.direction.endswith("-") else share

    def number(self, size: float, value: float, passed: Passed) -> float:
        return value * (1.0 + size)
