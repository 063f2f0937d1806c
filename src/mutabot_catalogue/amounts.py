"""Operators that mistake units, and that make commanded amounts too small, too large or limited."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar

from mutabot.api.faults import Context, Example, Subject, ValueOperator
from mutabot.api.values import Kind, Mode, Operation, Path, Quantity

from .values import CATALOGUE, like, middle_of, within

#: the robot, or the program, takes the number as if it were in the other unit
_TAKEN = "taken"
#: the number is worked out in the other unit, and not converted
_GIVEN = "given"

_BASE = {"frame": "base", "mode": Mode.TO}
_MOVE_TO = Operation.writing(
    "robot:Arm.move_to", "z", Kind.TRANSLATION, axis="z", unit="m", range=(0.0, 2.0), **_BASE
)
_MOVE_BY = Operation.writing("robot:Arm.move_by", "x", Kind.TRANSLATION, axis="x", unit="m", mode=Mode.BY)
_MOVE_IN_MM = Operation.writing(
    "robot:Arm.move_to", "x", Kind.TRANSLATION, axis="x", unit="mm", range=(0.0, 800.0), **_BASE
)
_TURN = Operation.writing("robot:Arm.turn_by", "yaw", Kind.ROTATION, axis="z", unit="deg", mode=Mode.BY)
_J1 = Quantity("[0]", Path.parse("[0]", rooted=False), Kind.ANGLE, "j1", "rad")
_JOINTS = Operation("robot:Arm.joints", result=(_J1,), command=False)
_IN_CM, _IN_MM = (Operation.reading("laser:distance", Kind.DISTANCE, unit=unit) for unit in ("cm", "mm"))
_WAIT = Operation.writing("cell:wait", "seconds", Kind.DURATION, unit="s")


class _OtherUnit(ValueOperator):
    """Takes numbers for another unit, or gives them so.

    Class attributes:
        units: the other unit, by a quantity's own.
        ways: which of the two mistakes.

    Stands for: A number in another unit: {units}.
    """

    family = CATALOGUE
    units: ClassVar[Mapping[str, str]]
    ways: ClassVar[tuple[str, ...]] = (_TAKEN, _GIVEN)

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.unit in self.units

    def variants_of(self, quantity: Quantity) -> Iterable[str]:
        return (f"{way}-{self.units[quantity.unit or '']}" for way in self.ways)

    def change(self, value: Any, context: Context) -> Any | None:
        way, _, other = context.subject.variant.partition("-")
        convert = context.quantity.from_unit if way == _TAKEN else context.quantity.to_unit
        return context.quantity.map_numbers(value, lambda number: like(number, convert(number, other)))

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        description = super().describe(subject, before, after)
        how = "taken for" if subject.variant.startswith(_TAKEN) else "given in"
        return f"{description} ({how} {self.units[subject.required_quantity.unit or '']})"


def _both_ways(units: Mapping[str, str]) -> dict[str, str]:
    """Return the units and their reverse."""
    return {**units, **{counterpart: unit for unit, counterpart in units.items()}}


class CentimetreForMetre(_OtherUnit):
    """A length or linear speed in metres is taken for, or given in, centimetres, or the reverse.

    Where: written and read quantities in m, cm, m/s or cm/s.
    """

    name = "cm-for-m"
    units = _both_ways({"m": "cm", "m/s": "cm/s"})
    examples = (
        Example.changed(_MOVE_TO, 0.5, 0.005, "taken-cm"),
        Example.changed(_MOVE_TO, 0.01, 1.0, "given-cm"),
        Example.changed(_IN_CM, 12.0, 0.12, "given-m"),
        Example.unchanged(_MOVE_TO, 0.5, "50 m is outside the range [0, 2]", "given-cm"),
    )


class MillimetreForMetre(_OtherUnit):
    """A length or linear speed in metres is taken for, or given in, millimetres, or the reverse.

    Where: written and read quantities in m or mm, and their speeds and accelerations.
    """

    name = "mm-for-m"
    units = _both_ways({"m": "mm", "m/s": "mm/s", "m/s^2": "mm/s^2"})
    examples = (
        Example.changed(_MOVE_BY, 0.5, 0.0005, "taken-mm"),
        Example.changed(_MOVE_BY, 0.5, 500.0, "given-mm"),
        Example.changed(_IN_MM, 12, 12000, "taken-m"),
        Example.unchanged(_MOVE_BY, 0.0, "zero is zero in any unit", "taken-mm"),
    )


class InchForMillimetre(_OtherUnit):
    """A length in millimetres is taken for, or given in, inches, or the reverse.

    Where: written and read quantities in mm or inch.
    """

    name = "inch-for-mm"
    units = _both_ways({"mm": "inch"})
    examples = (
        Example.changed(_MOVE_IN_MM, 10, 254, "taken-inch"),
        Example.changed(_MOVE_IN_MM, 254, 10, "given-inch"),
        Example.changed(_IN_MM, 508.0, 20.0, "given-inch"),
        Example.unchanged(_MOVE_IN_MM, 40, "1016 mm is out of range", "taken-inch"),
    )


class DegreeForRadian(_OtherUnit):
    """An angle or angular speed in radians is taken for, or given in, degrees, or the reverse.

    Where: written and read quantities in rad or deg, rotation vectors and Euler angles included, and their
    speeds and accelerations.
    """

    name = "deg-for-rad"
    units = _both_ways({"rad": "deg", "rad/s": "deg/s", "rad/s^2": "deg/s^2"})
    examples = (
        Example.changed(_TURN, 3.0, 171.88733853924697, "taken-rad"),
        Example.changed(_TURN, 180.0, 3.141592653589793, "given-rad"),
        Example.changed(_JOINTS, 1.0, 57.29577951308232, "given-deg"),
        Example.unchanged(_TURN, 0.0, "zero is zero in any unit", "given-rad"),
    )


class MillisecondForSecond(_OtherUnit):
    """A duration in seconds is taken for milliseconds (the reverse is omitted: it would only time out).

    Where: durations in s.
    """

    name = "ms-for-s"
    units: ClassVar[Mapping[str, str]] = {"s": "ms"}
    ways = (_TAKEN,)
    of_read = False
    examples = (
        Example.changed(_WAIT, 0.8, 0.0008, "taken-ms"),
        Example.unchanged(_WAIT, 0.0, "zero is zero in both units", "taken-ms"),
    )


_SPEED = Operation.writing("robot:Arm.set_speed", "speed", Kind.SPEED, unit="m/s", range=(0.0, 1.0))
_PRESS = Operation.writing("robot:Arm.press", "force", Kind.FORCE, unit="N")
_GRIP = Operation.writing("robot:Gripper.set_force", "newtons", Kind.FORCE, unit="N", range=(20.0, 235.0))
_LIMITED = Operation.writing("robot:Gripper.set_force", "newtons", Kind.FORCE, unit="N", range=(0.0, 100.0))
_PAYLOAD = Operation.writing("robot:Arm.set_payload", "mass", Kind.MASS, unit="kg", range=(0.0, 5.0))
_OPEN = Operation.writing("robot:Gripper.move", "width", Kind.OPENING, unit="mm", range=(0.0, 85.0))


class _Factor(ValueOperator):
    """Multiplies a commanded number; what leaves its range stays at the end of it.

    Class attributes:
        is_limited: whether it does.

    Stands for: A wrong parameter: {parameters}.
    """

    family = CATALOGUE
    of_read = False
    variants: ClassVar[Mapping[str, float]] = {"x0.5": 0.5, "x2": 2.0}
    is_limited: ClassVar[bool] = True

    def change(self, value: Any, context: Context) -> Any | None:
        limits = context.quantity.range if self.is_limited else None
        return context.quantity.map_numbers(
            value, lambda number: like(number, within(context.option * number, limits))
        )


class SpeedOverride(_Factor):
    """A speed or acceleration is 50 % or 200 % of the commanded one, within its range.

    Where: written quantities of kind speed, acceleration or jerk.
    """

    name = "speed-override"
    kinds = frozenset({Kind.SPEED, Kind.ACCELERATION, Kind.JERK})
    examples = (
        Example.changed(_SPEED, 0.5, 0.25, "x0.5"),
        Example.changed(_SPEED, 0.8, 1.0, "x2"),
        Example.unchanged(_SPEED, 1.0, "it is at the end of its range", "x2"),
    )


class ForceOverride(_Factor):
    """A force or torque is 50 % or 200 % of the commanded one, within its range.

    Where: written quantities of kind force or torque.
    """

    name = "force-override"
    kinds = frozenset({Kind.FORCE, Kind.TORQUE})
    examples = (
        Example.changed(_PRESS, 40.0, 20.0, "x0.5"),
        Example.changed(_PRESS, 40.0, 80.0, "x2"),
        Example.unchanged(_PRESS, 0.0, "twice nothing is nothing", "x2"),
    )


class WeakGrip(_Factor):
    """A gripper has 30 % of the commanded force, or the least of its range.

    Where: written quantities of kind force, in calls that command no motion.
    """

    name = "weak-grip"
    variants: ClassVar[Mapping[str, float]] = {"x0.3": 0.3}
    examples = (
        Example.changed(_GRIP, 160, 48, "x0.3"),
        Example.changed(_GRIP, 40, 20, "x0.3"),
        Example.unchanged(_GRIP, 20, "it is the least already", "x0.3"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        motions = (Kind.TRANSLATION, Kind.ROTATION)
        return quantity.kind is Kind.FORCE and not any(
            written.kind in motions or written.is_whole for written in whole.written
        )


class WrongPayload(_Factor):
    """The payload that is set is none, or twice as heavy.

    Where: written quantities of kind mass.
    """

    name = "wrong-payload"
    kinds = frozenset({Kind.MASS})
    variants: ClassVar[Mapping[str, float]] = {"none": 0.0, "double": 2.0}
    is_limited = False
    examples = (
        Example.changed(_PAYLOAD, 1.2, 0.0, "none"),
        Example.changed(_PAYLOAD, 1.2, 2.4, "double"),
        Example.unchanged(_PAYLOAD, 4.0, "the robot takes 5 kg at most", "double"),
        Example.unchanged(_PAYLOAD, 0.0, "there is no payload to forget", "none"),
    )


class PartialOpening(ValueOperator):
    """A gripper stops half way.

    Where: openings with a range or clip; those of two values take no other.

    Stands for: Commands that are not carried out in full, as by a gripper that jams: {commands}.
    """

    name = "partial-opening"
    family = CATALOGUE
    of_read = False
    examples = (
        Example.changed(_OPEN, 80.0, 40.0),
        Example.changed(_OPEN, 0.0, 42.5),
        Example.unchanged(_OPEN, {}, "the call says nothing of it"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind is Kind.OPENING and _has_limits(quantity)

    def change(self, value: Any, context: Context) -> Any | None:
        low, high = middle_of(context.quantity, 1.0)

        def half(number: float) -> float:
            far = low if number - low >= high - number else high
            return like(number, (number + far) / 2.0)

        return context.quantity.map_numbers(value, half)


class SilentLimit(ValueOperator):
    """A commanded value is limited to the middle 80 % of its range, without notice.

    Where: written numbers with a range or clip.

    Stands for: A wrong parameter: {parameters}.
    """

    name = "silent-limit"
    family = CATALOGUE
    of_read = False
    examples = (Example.changed(_LIMITED, 100, 90), Example.unchanged(_LIMITED, 50, "it is within"))

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        is_number = quantity.kind.is_measured or quantity.kind in (Kind.OPENING, Kind.OUTPUT)
        return is_number and _has_limits(quantity) and not quantity.is_whole

    def change(self, value: Any, context: Context) -> Any | None:
        limits = middle_of(context.quantity, 0.8)
        return context.quantity.map_numbers(value, lambda number: like(number, within(number, limits)))


def _has_limits(quantity: Quantity) -> bool:
    return (quantity.range or quantity.clip) is not None and quantity.values is None
