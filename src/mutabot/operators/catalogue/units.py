"""Numbers that are taken for another unit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from mutabot.families import CATALOGUE
from mutabot.model import Kind, Mode, Operation, Path, Quantity
from mutabot.model.quantity import Value
from mutabot.model.units import convert
from mutabot.operators.examples import changed, reading, unchanged, writing
from mutabot.operators.numbers import like, map_numbers
from mutabot.operators.operator import Context, Example, Subject, quantity_of
from mutabot.operators.studies import UNITS
from mutabot.operators.value import ValueOperator

#: the robot, or the program, takes the number as if it were in the other unit
_TAKEN = "taken"
#: the number is worked out in the other unit, and nobody converts it
_GIVEN = "given"

_METRES = Quantity("z", Path("z"), Kind.TRANSLATION, "z", "m", "base", Mode.TO, range=(0.0, 2.0))
_MOVE_TO = Operation("robot:Arm.move_to", (_METRES,))
_MOVE_BY = Operation(
    "robot:Arm.move_by", (Quantity("x", Path("x"), Kind.TRANSLATION, "x", "m", "base", Mode.BY),)
)
_MILLIMETRES = Quantity("x", Path("x"), Kind.TRANSLATION, "x", "mm", "base", Mode.TO, range=(0.0, 800.0))
_MOVE_IN_MM = Operation("robot:Arm.move_to", (_MILLIMETRES,))
_TURN = Operation(
    "robot:Arm.turn_by", (Quantity("yaw", Path("yaw"), Kind.ROTATION, "z", "deg", "base", Mode.BY),)
)
_J1 = Quantity("[0]", Path.parse("[0]", rooted=False), Kind.ANGLE, "j1", "rad")
_JOINTS = Operation("robot:Arm.joints", result=(_J1,), command=False)
_IN_CM, _IN_MM = (reading("laser:distance", Kind.DISTANCE, unit=unit) for unit in ("cm", "mm"))
_WAIT = writing("cell:wait", "seconds", Kind.DURATION, unit="s")


class _OtherUnit(ValueOperator):
    """Takes numbers for another unit, or gives them so.

    Class attributes:
        units: the other unit, by a quantity's own.
        ways: which of the two mistakes.
    """

    family = CATALOGUE
    stands_for = f"A number in another unit: {UNITS}."
    units: ClassVar[Mapping[str, str]]
    ways: ClassVar[tuple[str, ...]] = (_TAKEN, _GIVEN)

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.unit in self.units

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        return (f"{way}-{self.units[quantity.unit or '']}" for way in self.ways)

    def change(self, value: Value, context: Context) -> Value | None:
        way, _, other = context.subject.variant.partition("-")
        own = context.quantity.unit or ""
        units = (other, own) if way == _TAKEN else (own, other)
        return map_numbers(value, lambda number: like(number, convert(number, *units)))

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        told = super().describe(subject, before, after)
        how = "taken for" if subject.variant.startswith(_TAKEN) else "given in"
        return f"{told} ({how} {self.units[quantity_of(subject).unit or '']})"


def _both_ways(units: Mapping[str, str]) -> dict[str, str]:
    """The same units, and the other way round."""
    return {**units, **{other: one for one, other in units.items()}}


class CentimetreForMetre(_OtherUnit):
    """A length or linear speed in metres is taken for centimetres, or is given in centimetres; and the other
    way round.
    """

    name = "cm-for-m"
    rank = 300
    where = "written and read quantities in m, cm, m/s or cm/s"
    units = _both_ways({"m": "cm", "m/s": "cm/s"})
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_MOVE_TO, 0.5, 0.005, "taken-cm"),
        changed(_MOVE_TO, 0.01, 1.0, "given-cm"),
        changed(_IN_CM, 12.0, 0.12, "given-m"),
        unchanged(_MOVE_TO, 0.5, "50 m is outside the range [0, 2]", "given-cm"),
    )


class MillimetreForMetre(_OtherUnit):
    """A length or linear speed in metres is taken for millimetres, or is given in millimetres; and the other
    way round.
    """

    name = "mm-for-m"
    rank = 301
    where = "written and read quantities in m or mm, and their speeds and accelerations"
    units = _both_ways({"m": "mm", "m/s": "mm/s", "m/s^2": "mm/s^2"})
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_MOVE_BY, 0.5, 0.0005, "taken-mm"),
        changed(_MOVE_BY, 0.5, 500.0, "given-mm"),
        changed(_IN_MM, 12, 12000, "taken-m"),
        unchanged(_MOVE_BY, 0.0, "zero is zero in any unit", "taken-mm"),
    )


class InchForMillimetre(_OtherUnit):
    """A length in millimetres is taken for inches, or is given in inches; and the other way round."""

    name = "inch-for-mm"
    rank = 302
    where = "written and read quantities in mm or inch"
    units = _both_ways({"mm": "inch"})
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_MOVE_IN_MM, 10, 254, "taken-inch"),
        changed(_MOVE_IN_MM, 254, 10, "given-inch"),
        changed(_IN_MM, 508.0, 20.0, "given-inch"),
        unchanged(_MOVE_IN_MM, 40, "1016 mm is out of range", "taken-inch"),
    )


class DegreeForRadian(_OtherUnit):
    """An angle or angular speed in radians is taken for degrees, or is given in degrees; and the other way
    round.
    """

    name = "deg-for-rad"
    rank = 303
    where = (
        "written and read quantities in rad or deg, rotation vectors and Euler angles included, and"
        " their speeds and accelerations"
    )
    units = _both_ways({"rad": "deg", "rad/s": "deg/s", "rad/s^2": "deg/s^2"})
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_TURN, 3.0, 171.88733853924697, "taken-rad"),
        changed(_TURN, 180.0, 3.141592653589793, "given-rad"),
        changed(_JOINTS, 1.0, 57.29577951308232, "given-deg"),
        unchanged(_TURN, 0.0, "zero is zero in any unit", "given-rad"),
    )


class MillisecondForSecond(_OtherUnit):
    """A duration in seconds is taken for milliseconds. The other way round it is so long that any test only
    times out.
    """

    name = "ms-for-s"
    rank = 304
    where = "durations in s"
    units: ClassVar[Mapping[str, str]] = {"s": "ms"}
    ways = (_TAKEN,)
    of_read = False
    examples: ClassVar[tuple[Example, ...]] = (
        changed(_WAIT, 0.8, 0.0008, "taken-ms"),
        unchanged(_WAIT, 0.0, "no time is no time", "taken-ms"),
    )
