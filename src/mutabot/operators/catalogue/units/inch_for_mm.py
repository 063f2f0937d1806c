"""inch-for-mm: millimetres are taken for inches, or inches for millimetres"""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.operators._evidence import UNITS
from mutabot.operators.operator import Example, Subject

from ._factor import OtherUnit, both_ways

_X = Quantity("x", Path("x"), Kind.TRANSLATION, "x", "mm", "base", Mode.TO, range=(0.0, 800.0))
_MOVE = Operation("robot:Arm.move_to", (_X,))
_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "mm")
_MEASURE = Operation("laser:distance", result=(_GAP,), command=False)


class InchForMillimetre(OtherUnit):
    """Takes millimetres for inches, or gives them so."""

    name = "inch-for-mm"
    summary = "A length in millimetres is taken for inches, or is given in inches; and the other way round."
    rank = 302
    stands_for = f"A number in another unit: {UNITS}."
    where = "written and read quantities in mm or inch"
    units = both_ways({"mm": "inch"})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_MOVE, quantity=_X, variant="taken-inch"), {"x": 10}, performed=({"x": 254},)),
        Example(Subject(_MOVE, quantity=_X, variant="given-inch"), {"x": 254}, performed=({"x": 10},)),
        Example(
            Subject(_MEASURE, quantity=_GAP, variant="given-inch"),
            replied={"result": 508.0},
            performed=({},),
            received={"result": 20.0},
        ),
        Example(Subject(_MOVE, quantity=_X, variant="taken-inch"), {"x": 40}, away="1016 mm is out of range"),
    )
