"""deg-for-rad: an angle is taken for degrees, or for radians"""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.operators._evidence import UNITS
from mutabot.operators.operator import Example, Subject

from ._factor import OtherUnit, both_ways

_YAW = Quantity("yaw", Path("yaw"), Kind.ROTATION, "z", "deg", "base", Mode.BY)
_TURN = Operation("robot:Arm.turn_by", (_YAW,))
_J1 = Quantity("[0]", Path.parse("[0]", rooted=False), Kind.ANGLE, "j1", "rad")
_JOINTS = Operation("robot:Arm.joints", result=(_J1,), command=False)


class DegreeForRadian(OtherUnit):
    """Takes radians for degrees, or gives them so."""

    name = "deg-for-rad"
    summary = (
        "An angle or angular speed in radians is taken for degrees, or is given in degrees; and the"
        " other way round."
    )
    rank = 303
    stands_for = f"A number in another unit: {UNITS}."
    where = (
        "written and read quantities in rad or deg, rotation vectors and Euler angles included, and"
        " their speeds and accelerations"
    )
    units = both_ways({"rad": "deg", "rad/s": "deg/s", "rad/s^2": "deg/s^2"})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_TURN, quantity=_YAW, variant="taken-rad"),
            {"yaw": 3.0},
            performed=({"yaw": 171.88733853924697},),
        ),
        Example(
            Subject(_TURN, quantity=_YAW, variant="given-rad"),
            {"yaw": 180.0},
            performed=({"yaw": 3.141592653589793},),
        ),
        Example(
            Subject(_JOINTS, quantity=_J1, variant="given-deg"),
            replied={"[0]": 1.0},
            performed=({},),
            received={"[0]": 57.29577951308232},
        ),
        Example(
            Subject(_TURN, quantity=_YAW, variant="given-rad"), {"yaw": 0.0}, away="zero is zero in any unit"
        ),
    )
