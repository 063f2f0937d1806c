"""Quantities: the meaning of an argument or of a part of a result, and when two values are the same.

Orientations may be attributes of an object, as the ``x``, ``y``, ``z`` and ``w`` of a message's quaternion
are. A stamp of ROS 2 has ``sec`` and ``nanosec``, one of ROS 1 ``secs`` and ``nsecs``. Seconds since 1970
lose some hundred nanoseconds as one number, so a stamp is written anew only where its value changes.

Two values are the same if the robot, or the program that reads them, cannot distinguish them. Plan, engines
and operators of all families ask here, so that none plants a fault that another leaves out.
"""

from __future__ import annotations

import copy
import math
import re
from array import array
from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import StrEnum
from math import isclose
from typing import Any

from mutabot.frozen import frozen
from mutabot.model.data import UNKNOWN, data_of, in_place_of
from mutabot.model.enumeration import is_member, member_of, written_of
from mutabot.model.path import Path, Step
from mutabot.model.units import UNITS, Dimension, Quaternion, convert, to_quaternion, to_values

_PARTS = (("sec", "nanosec"), ("secs", "nsecs"))
_NANO = 1_000_000_000
#: radians within which two orientations are the same
_SAME_ORIENTATION = 1e-9
#: the same where they are a full turn apart, as half a turn and its opposite are: people write it as 3.1416
_TURNED_ROUND = 1e-3


def seconds_of(stamp: Any) -> float | None:
    """Return the seconds of a time stamp or a number; None for anything else."""
    if isinstance(stamp, int | float) and not isinstance(stamp, bool):
        return float(stamp)
    for whole, rest in _PARTS:
        if hasattr(stamp, whole) and hasattr(stamp, rest):
            return float(getattr(stamp, whole) + getattr(stamp, rest) / _NANO)
    return None


def with_seconds(stamp: Any, seconds: float) -> Any:
    """Return a copy of a stamp with this many seconds, at least zero."""
    whole, rest = divmod(max(0, round(seconds * _NANO)), _NANO)
    for names in _PARTS:
        if all(hasattr(stamp, name) for name in names):
            copied = copy.copy(stamp)
            setattr(copied, names[0], whole)
            setattr(copied, names[1], rest)
            return copied
    return float(seconds)


_NAMES = re.compile(r"[._]")
#: digits that distinguish any two numbers
_MOST_DIGITS = 17
#: A value a quantity can have, in the quantity's own unit.
Value = Any


class Kind(StrEnum):
    """The kind of a quantity, mostly a physical one.

    A setting is what something is set up with, such as the name of a topic; no vocabulary describes it.
    """

    TRANSLATION = "translation"
    ROTATION = "rotation"
    OPENING = "opening"
    OUTPUT = "output"
    DURATION = "duration"
    POSITION = "position"
    ORIENTATION = "orientation"
    ANGLE = "angle"
    DISTANCE = "distance"
    ROTATION_VECTOR = "rotation_vector"
    QUATERNION = "quaternion"
    EULER = "euler"
    LABEL = "label"
    FLAG = "flag"
    FRAME_ID = "frame_id"
    STAMP = "stamp"
    SPEED = "speed"
    ACCELERATION = "acceleration"
    JERK = "jerk"
    FORCE = "force"
    TORQUE = "torque"
    MASS = "mass"
    TEMPERATURE = "temperature"
    VOLTAGE = "voltage"
    CURRENT = "current"
    PRESSURE = "pressure"
    FREQUENCY = "frequency"
    RATIO = "ratio"
    COUNT = "count"
    NUMBER = "number"
    SETTING = "setting"

    @property
    def is_measured(self) -> bool:
        """Whether its values are numbers on a scale with a unit."""
        return self in MEASURED

    @property
    def is_whole(self) -> bool:
        """Whether its values are complete orientations."""
        return self in WHOLE


class Mode(StrEnum):
    """Whether a commanded amount is relative or an absolute target."""

    BY = "by"
    TO = "to"


#: orientations as a whole: several numbers that mean something only together; written and read
WHOLE = frozenset({Kind.ROTATION_VECTOR, Kind.QUATERNION, Kind.EULER})
#: what a message says of itself: the name of the frame it is given in, and when that was; written and read
HEADER = frozenset({Kind.FRAME_ID, Kind.STAMP})
#: numbers on a scale that say neither where something is nor how long it takes; written and read
PLAIN = frozenset(
    {
        Kind.SPEED, Kind.ACCELERATION, Kind.JERK, Kind.FORCE, Kind.TORQUE, Kind.MASS, Kind.TEMPERATURE,
        Kind.VOLTAGE, Kind.CURRENT, Kind.PRESSURE, Kind.FREQUENCY, Kind.RATIO, Kind.COUNT, Kind.NUMBER,
    }
)  # fmt: skip
#: kinds that are written to the robot
WRITTEN = frozenset(
    {Kind.TRANSLATION, Kind.ROTATION, Kind.OPENING, Kind.OUTPUT, Kind.DURATION, *WHOLE, *HEADER, *PLAIN}
)
#: kinds that are read from the robot
READ = frozenset(
    {Kind.POSITION, Kind.ORIENTATION, Kind.ANGLE, Kind.DISTANCE, Kind.LABEL, Kind.FLAG}
    | WHOLE | HEADER | PLAIN
)  # fmt: skip
#: what each kind measures; kinds that are missing carry no unit. Plain ones measure what they are called by,
#: along an axis or about it
DIMENSIONS: dict[Kind, frozenset[Dimension]] = {
    **dict.fromkeys((Kind.TRANSLATION, Kind.POSITION, Kind.DISTANCE), frozenset({Dimension.LENGTH})),
    **dict.fromkeys((Kind.ROTATION, Kind.ORIENTATION, Kind.ANGLE), frozenset({Dimension.ANGLE})),
    **dict.fromkeys((Kind.ROTATION_VECTOR, Kind.EULER), frozenset({Dimension.ANGLE})),
    Kind.OPENING: frozenset({Dimension.RATIO, Dimension.LENGTH}),
    Kind.DURATION: frozenset({Dimension.TIME}),
    **{
        kind: frozenset(dimension for dimension in Dimension if dimension.removeprefix("angular ") == kind)
        for kind in PLAIN - {Kind.COUNT, Kind.NUMBER}
    },
}


def measures_of(kind: Kind) -> tuple[Dimension, ...]:
    """Return the dimensions of faults in a quantity of this kind; orientations have faults in angles."""
    return (Dimension.ANGLE,) if kind in WHOLE else tuple(DIMENSIONS.get(kind, ()))


#: kinds whose values are numbers on a scale, with a unit
MEASURED = frozenset(DIMENSIONS.keys() - {Kind.OPENING} | WHOLE | PLAIN)
#: the reading of where a written kind is now
READING_OF: dict[Kind, Kind] = {Kind.TRANSLATION: Kind.POSITION, Kind.ROTATION: Kind.ORIENTATION}


@frozen(refuses=True)
class Quantity:
    """The meaning of an argument, or of a part of a result.

    Attributes:
        name: how ids and reports call it (``dx``, ``.pose.x``, ``height``, ``result``).
        path: where it lies, starting at the argument's name, the result, or the field of a text command.
        kind: its physical meaning.
        axis: ``x``, ``y``, ``z``, or ``j1`` … for a joint; None where it has none.
        unit: a key of ``units.UNITS``; None for kinds without one. All values below are in this unit.
        frame: name of the frame it is given in, or None if the vocabulary does not say.
        mode: relative or absolute; None for quantities that are not commanded motions.
        values: the allowed values of a discrete quantity, or None for a continuous one.
        range: least and greatest allowed value, or None for no limit.
        clip: what the robot or its environment limits a value to that is sent: values beyond are taken for
            the nearer end; None if it does not.
        noise: standard deviation of the sensor noise to plant, or None for the operator's default.
        order: of the parts of a quaternion (``wxyz`` or ``xyzw``), or the axes of Euler angles; else None.
        relative: whether the program computes this absolute target from where the robot is, so that it hides
            a relative move.
        ladder: the magnitudes of graded faults to try, in ``ladder_unit``, rising; None for the usual ones.
        ladder_unit: the unit of these; it measures what the quantity measures, or a time, or a ratio; only
            graded faults of that measure follow it. None for its own unit.
        missing: what a reading gives that is not there: ``none``, ``nan``, or an exception that is raised
            (``module:Name``); None if the vocabulary does not say.
        tcp: the part of the tool centre point's offset that lies along this axis, in its unit; None if the
            vocabulary does not say.
        by_number: whether values differ that mean the same to a robot, such as 180 and −180 degrees: where no
            robot gets them, but something that tests compare with numbers.
    """

    name: str
    path: Path
    kind: Kind
    axis: str | None = None
    unit: str | None = None
    frame: str | None = None
    mode: Mode | None = None
    values: tuple[Value, ...] | None = None
    range: tuple[float, float] | None = None
    noise: float | None = None
    clip: tuple[float, float] | None = None
    order: str | None = None
    relative: bool = False
    ladder: tuple[float, ...] | None = None
    ladder_unit: str | None = None
    missing: str | None = None
    tcp: float | None = None
    by_number: bool = False

    def get(self, start: Any) -> Value:
        """Read its value from the object that its path starts at, see ``of``. Raises PathError."""
        return self.of(self.path.get(start))

    def of(self, value: Any) -> Value:
        """Return the value at the end of its path, with stamps in seconds and orientations as numbers.

        A member of an enumeration is what ``values`` write for it. ``data.UNKNOWN`` if it is unsafe to look
        into it. Raises PathError.
        """
        if self.values is not None and is_member(value):
            return written_of(value, self.values)
        if self.is_whole:
            value = numbers_of(value, self._parts)
        elif self.kind is Kind.STAMP:
            data = data_of(value)
            return seconds_of(value if data is UNKNOWN else data)
        return data_of(value)

    def put(self, start: Any, value: Value) -> Any:
        """Return a copy of the start of its path, with another value or None put in.

        The value is of the class of what was there, such as a decimal, where that can be.
        """
        before = self.path.get(start)
        if value is None:
            return self.path.put(start, None)
        if self.kind is Kind.STAMP:
            value = with_seconds(before, value)
        elif self.is_whole:
            value = with_numbers(before, self._parts, value)
        elif self.values is not None and is_member(before):
            member = member_of(type(before), value)
            value = value if member is None else member
        return self.path.put(start, in_place_of(before, value))

    @property
    def _parts(self) -> str:
        """The names of an orientation's parts, if they are attributes."""
        return "xyz" if self.kind is Kind.ROTATION_VECTOR else (self.order or "").lower()

    def allows(self, value: Value) -> bool:
        """Return whether the robot API accepts this value, as far as the vocabulary describes that."""
        if self.values is not None and value not in self.values:
            return False
        if self.range is not None:
            return bool(self.range[0] <= self.clipped(value) <= self.range[1])
        return True

    def clipped(self, value: Value) -> Value:
        """Limit a number, or each number of a vector, by ``clip``; return other values unchanged."""
        if self.clip is None or isinstance(value, str | bytes | bool | None):
            return value
        if hasattr(value, "__len__"):
            return [self.clipped(item) for item in value]
        return min(max(value, self.clip[0]), self.clip[1])

    @property
    def is_whole(self) -> bool:
        """Whether its value is a complete orientation."""
        return self.kind in WHOLE

    @property
    def is_numeric(self) -> bool:
        """Whether its values are one or several numbers that operators can change."""
        return self.values is None and self.kind in DIMENSIONS and not self.is_whole

    @property
    def full_turn(self) -> float | None:
        """A full turn in its unit, if a full turn makes no difference; None otherwise, also for joints."""
        is_joint = self.axis is not None and self.axis.startswith("j")
        is_target = self.kind is Kind.ROTATION and self.mode is Mode.TO
        if is_joint or not (is_target or self.kind in (Kind.ORIENTATION, Kind.ANGLE)):
            return None
        return self.from_unit(2.0 * math.pi, "rad")

    def orientation(self, value: Value) -> Quaternion | None:
        """Return a value's orientation as a unit quaternion; None if it is no orientation."""
        if not self.is_whole:
            return None
        return to_quaternion(
            value, self.kind, self.order, lambda angle: convert(angle, self.unit or "rad", "rad")
        )

    def numbers(self, orientation: Quaternion) -> list[float]:
        """Return an orientation in the notation of this quantity."""
        return to_values(orientation, self.kind, self.order, lambda angle: self.from_unit(angle, "rad"))

    def from_unit(self, value: float, unit: str) -> float:
        """Return ``value``, given in ``unit``, in this quantity's own unit."""
        return convert(value, unit, self.unit) if self.unit is not None else value

    def to_unit(self, value: float, unit: str) -> float:
        """Return ``value``, given in this quantity's own unit, in ``unit``."""
        return convert(value, self.unit, unit) if self.unit is not None else value

    @property
    def ends(self) -> tuple[Value, Value] | None:
        """Its two values, or the ends of its range; None for other quantities."""
        if self.values is not None:
            return (self.values[0], self.values[1]) if len(self.values) == 2 else None
        return self.range or self.clip

    def other_end(self, value: Value) -> Value | None:
        """Return the other of its two end values, as open for close; None if the value is neither."""
        ends, value = self.ends, self.clipped(value)
        if ends is None or value is None or value not in ends:
            return None
        return ends[1] if value == ends[0] else ends[0]

    def is_same(self, first: Value, second: Value) -> bool:
        """Return whether neither the robot nor the program can distinguish two values.

        Orientations as a whole are the same if the angle between them is none, in whichever writing; targets
        of rotations modulo a full turn; numbers, and the parts of vectors, up to the rounding of
        computations.
        """
        if first is second:
            return True
        kind = self.kind
        if kind in WHOLE and not self.by_number:
            before, after = self.orientation(first), self.orientation(second)
            if before is not None and after is not None:
                return before.distance(after) < _SAME_ORIENTATION
        if kind not in MEASURED and kind is not Kind.STAMP:
            return same(first, second)
        return _are_same(self, _listed(first), _listed(second))

    def rotated(
        self, value: Value, change: Callable[[Quaternion], Quaternion], least: float = _SAME_ORIENTATION
    ) -> Value | None:
        """Return an orientation rotated by ``change``, in the same notation; None if it is no orientation.

        Args:
            value: the orientation, in this quantity's writing.
            change: makes the other orientation of it.
            least: radians; where both are less than that apart, it is ``value`` itself.
        """
        before = self.orientation(value)
        if before is None:
            return None
        after = change(before)
        if before.distance(after) < least and not self.by_number:
            return value
        parts = iter(self.numbers(after))
        return self.map_numbers(value, lambda _: next(parts) + 0.0)  # no −0

    def inverted(self, value: Value) -> Value | None:
        """Return the inverse rotation in the same notation; ``value`` itself if both are the same."""
        return self.rotated(value, lambda orientation: orientation.inverse, _TURNED_ROUND)

    @staticmethod
    def is_scalar(value: Value) -> bool:
        """Return whether a value is a single number, including numpy's scalars, but not a truth value."""
        if isinstance(value, bool) or type(value).__name__ in ("bool_", "bool"):
            return False
        return isinstance(value, int | float) or (
            hasattr(value, "__float__") and not hasattr(value, "__len__")
        )

    @classmethod
    def map_numbers(cls, value: Value, change: Callable[[Any], float]) -> Value | None:
        """Apply ``change`` to a number, or to each number of a vector; None for other values.

        The container's type is kept: lists stay lists, tuples tuples, arrays arrays. An array of whole
        numbers becomes one of floating-point numbers.
        """
        kind = getattr(getattr(value, "dtype", None), "kind", "")
        if cls.is_scalar(value):
            return change(int(value) if kind == "u" else value)  # an unsigned number has no other sign
        if isinstance(value, list | tuple) and value and all(cls.is_scalar(item) for item in value):
            return type(value)(change(item) for item in value)
        if isinstance(value, array) and len(value):
            return array(value.typecode if value.typecode in "fd" else "d", [change(item) for item in value])
        if kind in ("f", "i", "u") and getattr(value, "ndim", 0) == 1:
            changed = value.copy() if kind == "f" else value.astype(float)
            for index in range(len(changed)):
                changed[index] = change(changed[index])
            return changed
        return None

    @property
    def label(self) -> str:
        """The name in descriptions: its axis, if any, and its name."""
        name = self.name.lstrip(".")
        if self.axis is None or self.axis in _NAMES.split(name):
            return name
        return f"{name} ({self.axis})"

    def text(self, value: Value, digits: int = 6) -> str:
        """Return a value as reports print it, with its unit."""
        if self.is_whole and isinstance(value, list | tuple):
            parts = [f"{part:.{digits}g}" if isinstance(part, int | float) else str(part) for part in value]
            return f"({', '.join(parts)}){f' {self.unit}' if self.unit else ''}"
        if isinstance(value, bool) or not isinstance(value, int | float):
            return str(value)
        number = f"{value:.{digits}g}"
        return f"{number} {self.unit}" if self.unit not in (None, "fraction") else number

    def texts(self, first: Value, second: Value) -> tuple[str, str]:
        """Return two values as reports print them side by side."""
        return distinct_texts(first, second, self.text, 6)


def distinct_texts(
    first: Value, second: Value, text: Callable[[Value, int], str], digits: int
) -> tuple[str, str]:
    """Return two values as texts with enough significant digits to differ, and at least ``digits``."""
    for more in range(digits, _MOST_DIGITS + 1):
        texts = text(first, more), text(second, more)
        if texts[0] != texts[1]:
            return texts
    return text(first, digits), text(second, digits)


def is_reading_of(reading: Quantity, written: Quantity) -> bool:
    """Return whether a reading gives the start of a commanded motion: same axis and compatible frame.

    The target that was sent last gives it as well.
    """
    frames = {reading.frame, written.frame} - {None}
    if reading.axis != written.axis or len(frames) > 1:
        return False
    is_joint = written.axis is not None and written.axis.startswith("j")
    if reading.kind is written.kind and reading.mode is Mode.TO:
        return reading.kind in READING_OF
    return reading.kind is READING_OF.get(written.kind) or (
        is_joint and written.kind is Kind.ROTATION and reading.kind is Kind.ANGLE
    )


def is_number(value: Any) -> bool:
    """Return whether a value is a number; booleans are not."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def holds_number(value: Any) -> bool:
    """Return whether a recorded value is or contains a number; foreign number types are recorded as texts."""
    if isinstance(value, list | tuple):
        return any(map(holds_number, value))
    if isinstance(value, str):
        try:
            float(value)
        except ValueError:
            return False
        return True
    return is_number(value)


#: numbers below it are written without a power of ten
_LONG_NUMBER = 1e9


def value_text(value: Any, digits: int = 4) -> str:
    """Return a value as divergence lines print it."""
    if value is None:
        return "nothing"
    if is_number(value):
        text = f"{value:.{digits}g}"
        return f"{value:.0f}" if "e+" in text and abs(value) < _LONG_NUMBER else text
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {value_text(item, digits)}" for key, item in value.items()) + "}"
    if isinstance(value, list | tuple) and not value:
        return "[]"
    if isinstance(value, list | tuple):
        return "(" + ", ".join(value_text(item, digits) for item in value) + ")"
    return str(value)


def same(first: Value, second: Value) -> bool:
    """Return whether two values are equal; arrays by their elements, NaN equal to itself.

    A difference that is but rounding of the computation is none: no robot could show it.
    """
    if first is second:
        return True
    are_floats = isinstance(first, float) and isinstance(second, float)
    if are_floats and isclose(first, second, rel_tol=_RELATIVE, abs_tol=_ABSOLUTE):
        return True
    first, second = _listed(first), _listed(second)
    try:
        return bool(first == second) or bool(first != first and second != second)  # noqa: PLR0124  # NaN
    except Exception:  # a value of the user's may compare in any way; what cannot be compared differs
        return False


def _listed(value: Value) -> Value:
    """Return an array or a scalar of numpy as plain values; others unchanged."""
    return value.tolist() if hasattr(type(value), "tolist") else value


def numbers_of(value: Any, names: Sequence[str]) -> Any:
    """Read the named attributes of an object as numbers; return other values unchanged."""
    if value is None or hasattr(value, "__len__") or not all(hasattr(value, name) for name in names):
        return value
    return [getattr(value, name) for name in names]


def with_numbers(value: Any, names: Sequence[str], numbers: Any) -> Any:
    """Return a copy of an object with other numbers in these attributes.

    Raises PathError if it cannot be copied and changed.
    """
    if numbers_of(value, names) is value:
        return numbers
    for name, number in zip(names, numbers, strict=True):
        value = Path(None, (Step(attribute=name),)).put(value, number)
    return value


#: share of a value that no robot shows: a thousand times finer than the 24 bits of the best encoders
_RELATIVE = 1e-9
#: the same next to zero, in the SI's unit. A picometre is what sums of coordinates of some hundred metres
#: are rounded by (2⁻⁵² of each, several times over), and far below the finest step of any drive
_ABSOLUTE = 1e-12
#: share of a stamp: seconds since 1970 have sixteen digits, of which all but the last count
_OF_STAMP = 1e-15
#: seconds below which stamps are the same: messages count nanoseconds
_NANOSECOND = 1e-9


def are_same(quantities: Iterable[Quantity], first: Mapping[str, Value], second: Mapping[str, Value]) -> bool:
    """Return whether neither the robot nor the program can distinguish the values of two calls."""
    return first.keys() == second.keys() and not changes(quantities, second, first)


def changes(
    quantities: Iterable[Quantity], before: Mapping[str, Value], after: Mapping[str, Value]
) -> dict[str, Value]:
    """Return the values of a call that are new or differ from ``before``."""
    is_same = {quantity.name: quantity.is_same for quantity in quantities}
    return {
        name: value
        for name, value in after.items()
        if name not in before or not is_same.get(name, same)(before[name], value)
    }


def _are_same(quantity: Quantity, left: Value, right: Value) -> bool:
    if isinstance(left, list | tuple) and isinstance(right, list | tuple):
        return len(left) == len(right) and all(
            _are_same(quantity, first, second) for first, second in zip(left, right, strict=True)
        )
    if not (is_number(left) and is_number(right)):
        return same(left, right)
    if left == right:
        return True
    if not (math.isfinite(left) and math.isfinite(right)):
        return same(left, right)
    return _is_rounding(quantity, left, right) or _is_full_turn(quantity, left, right)


def _is_rounding(quantity: Quantity, first: float, second: float) -> bool:
    if isinstance(first, int) and isinstance(second, int):
        return False  # whole numbers are not rounded: two counts of an encoder are two places
    if quantity.kind is Kind.STAMP:
        return math.isclose(first, second, rel_tol=_OF_STAMP, abs_tol=_NANOSECOND)
    factor = UNITS[quantity.unit].factor if quantity.unit is not None else 1.0
    return math.isclose(first, second, rel_tol=_RELATIVE, abs_tol=max(_ABSOLUTE / factor, _ABSOLUTE))


def _is_full_turn(quantity: Quantity, first: float, second: float) -> bool:
    """Return whether the targets of a rotation lie one or several full turns apart."""
    turn = _turn_of_target(quantity)
    if turn is None or abs(first - second) < 0.5 * turn:
        return False
    return abs(math.remainder(first - second, turn)) <= _TURNED_ROUND * turn / (2.0 * math.pi)


def _turn_of_target(quantity: Quantity) -> float | None:
    """Return a full turn if the robot treats targets that lie a full turn apart as the same.

    A program that reads an angle may well distinguish 180 from −180 degrees. So does a joint, and
    so does whatever has a range of more than one turn: it winds.
    """
    if quantity.kind is not Kind.ROTATION or quantity.mode is not Mode.TO or quantity.by_number:
        return None
    turn = quantity.full_turn
    if turn is None:
        return None
    limits = quantity.range or quantity.clip
    winds = limits is not None and limits[1] - limits[0] > turn * (1.0 + 1e-6)
    return None if winds else turn
