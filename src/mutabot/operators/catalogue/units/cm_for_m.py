"""cm-for-m: a length is taken for centimetres, or given in them"""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.operators._evidence import UNITS
from mutabot.operators.operator import Example, Subject

from ._factor import OtherUnit, both_ways

_Z = Quantity("z", Path("z"), Kind.TRANSLATION, "z", "m", "base", Mode.TO, range=(0.0, 2.0))
_MOVE = Operation("robot:Arm.move_to", (_Z,))
_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "cm")
_MEASURE = Operation("laser:distance", result=(_GAP,), command=False)


class CentimetreForMetre(OtherUnit):
    """Takes metres for centimetres, or gives them so."""

    name = "cm-for-m"
    summary = (
        "A length or linear speed in metres is taken for centimetres, or is given in centimetres; and"
        " the other way round."
    )
    rank = 300
    stands_for = f"A number in another unit: {UNITS}."
    where = "written and read quantities in m, cm, m/s or cm/s"
    units = both_ways({"m": "cm", "m/s": "cm/s"})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_MOVE, quantity=_Z, variant="taken-cm"), {"z": 0.5}, performed=({"z": 0.005},)),
        Example(Subject(_MOVE, quantity=_Z, variant="given-cm"), {"z": 0.01}, performed=({"z": 1.0},)),
        Example(
            Subject(_MEASURE, quantity=_GAP, variant="given-m"),
            replied={"result": 12.0},
            performed=({},),
            received={"result": 0.12},
        ),
        Example(
            Subject(_MOVE, quantity=_Z, variant="given-cm"),
            {"z": 0.5},
            away="50 m is outside the range [0, 2]",
        ),
    )
