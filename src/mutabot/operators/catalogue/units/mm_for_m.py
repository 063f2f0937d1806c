"""mm-for-m: a length is taken for millimetres, or given in them"""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.operators._evidence import UNITS
from mutabot.operators.operator import Example, Subject

from ._factor import OtherUnit, both_ways

_X = Quantity("x", Path("x"), Kind.TRANSLATION, "x", "m", "base", Mode.BY)
_MOVE = Operation("robot:Arm.move_by", (_X,))
_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "mm")
_MEASURE = Operation("laser:distance", result=(_GAP,), command=False)


class MillimetreForMetre(OtherUnit):
    """Takes metres for millimetres, or gives them so."""

    name = "mm-for-m"
    summary = (
        "A length or linear speed in metres is taken for millimetres, or is given in millimetres; and"
        " the other way round."
    )
    rank = 301
    stands_for = f"A number in another unit: {UNITS}."
    where = "written and read quantities in m or mm, and their speeds and accelerations"
    units = both_ways({"m": "mm", "m/s": "mm/s", "m/s^2": "mm/s^2"})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_MOVE, quantity=_X, variant="taken-mm"), {"x": 0.5}, performed=({"x": 0.0005},)),
        Example(Subject(_MOVE, quantity=_X, variant="given-mm"), {"x": 0.5}, performed=({"x": 500.0},)),
        Example(
            Subject(_MEASURE, quantity=_GAP, variant="taken-m"),
            replied={"result": 12},
            performed=({},),
            received={"result": 12000},
        ),
        Example(Subject(_MOVE, quantity=_X, variant="taken-mm"), {"x": 0.0}, away="zero is zero in any unit"),
    )
