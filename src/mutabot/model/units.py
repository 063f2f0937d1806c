"""Units that a vocabulary may use, with their conversion to SI, and orientations.

Orientations are unit quaternions (w, x, y, z). Two orientations are as far apart as the angle of the one
rotation that leads from the first to the second, between 0 and half a turn: 2·atan2(|v|, |w|) of the
quaternion between them. Euler angles are read out after Bernardes and Viollet, "Quaternion to Euler angles
conversion: A direct, general and computationally efficient method", PLoS ONE 17 (2022) e0276302.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from enum import StrEnum
from itertools import pairwise
from typing import Any, NamedTuple


class Dimension(StrEnum):
    """What a unit measures."""

    LENGTH = "length"
    ANGLE = "angle"
    TIME = "time"
    RATIO = "ratio"
    SPEED = "speed"
    ANGULAR_SPEED = "angular speed"
    ACCELERATION = "acceleration"
    ANGULAR_ACCELERATION = "angular acceleration"
    JERK = "jerk"
    ANGULAR_JERK = "angular jerk"
    FORCE = "force"
    TORQUE = "torque"
    MASS = "mass"
    TEMPERATURE = "temperature"
    VOLTAGE = "voltage"
    CURRENT = "current"
    PRESSURE = "pressure"
    FREQUENCY = "frequency"


class Unit(NamedTuple):
    """A unit.

    Attributes:
        dimension: what it measures.
        factor: how many of the SI's unit (metre, radian, second, fraction, kilogram …) it is.
        zero: where its scale begins, in the SI's unit.
    """

    dimension: Dimension
    factor: float
    zero: float = 0.0


_DEGREE = math.pi / 180.0
#: by dimension, how many of the SI's unit each unit is; a test holds them against pint's
_FACTORS: dict[Dimension, dict[str, float]] = {
    Dimension.LENGTH: {"m": 1.0, "cm": 0.01, "mm": 0.001, "um": 1e-6, "inch": 0.0254},
    Dimension.ANGLE: {"rad": 1.0, "mrad": 0.001, "deg": _DEGREE},
    Dimension.TIME: {"s": 1.0, "ms": 0.001, "us": 1e-6, "min": 60.0},
    Dimension.RATIO: {"fraction": 1.0, "percent": 0.01},
    Dimension.SPEED: {"m/s": 1.0, "cm/s": 0.01, "mm/s": 0.001, "mm/min": 0.001 / 60.0},
    Dimension.ANGULAR_SPEED: {"rad/s": 1.0, "deg/s": _DEGREE, "rpm": 2.0 * math.pi / 60.0},
    Dimension.ACCELERATION: {"m/s^2": 1.0, "mm/s^2": 0.001},
    Dimension.ANGULAR_ACCELERATION: {"rad/s^2": 1.0, "deg/s^2": _DEGREE},
    Dimension.JERK: {"m/s^3": 1.0, "mm/s^3": 0.001},
    Dimension.ANGULAR_JERK: {"rad/s^3": 1.0, "deg/s^3": _DEGREE},
    Dimension.FORCE: {"N": 1.0, "kN": 1000.0},
    Dimension.TORQUE: {"Nm": 1.0, "Nmm": 0.001},
    Dimension.MASS: {"kg": 1.0, "g": 0.001},
    Dimension.TEMPERATURE: {"K": 1.0, "degC": 1.0, "degF": 5.0 / 9.0},
    Dimension.VOLTAGE: {"V": 1.0, "mV": 0.001},
    Dimension.CURRENT: {"A": 1.0, "mA": 0.001},
    Dimension.PRESSURE: {"Pa": 1.0, "kPa": 1000.0, "mbar": 100.0, "bar": 1e5, "psi": 6894.757293168361},
    Dimension.FREQUENCY: {"Hz": 1.0, "kHz": 1000.0},
}
#: where the scales of temperatures begin, in K
_ZEROS = {"degC": 273.15, "degF": 273.15 - 32.0 * 5.0 / 9.0}
#: by the names that vocabularies write
UNITS: dict[str, Unit] = {
    name: Unit(dimension, factor, _ZEROS.get(name, 0.0))
    for dimension, factors in _FACTORS.items()
    for name, factor in factors.items()
}


#: what every quantity can be off by beside its own measure: it comes late, or is scaled
OF_ANY = (Dimension.TIME, Dimension.RATIO)


def units_of(dimensions: Collection[Dimension]) -> tuple[str, ...]:
    """Return the units of these dimensions."""
    return tuple(name for name, unit in UNITS.items() if unit.dimension in dimensions)


def dimension_of(unit: str) -> Dimension:
    """Return the dimension a unit measures. Raises KeyError for an unknown unit."""
    return UNITS[unit].dimension


def convert(value: float, unit: str, to: str) -> float:
    """Return ``value``, given in ``unit``, in the unit ``to``.

    Raises ValueError when the two units measure different things. A conversion between equal units
    returns the value untouched, so that nothing is rounded without need.
    """
    source, target = _both(unit, to)
    if unit == to:
        return value
    if source.zero == target.zero:
        return value * source.factor / target.factor
    return (value * source.factor + source.zero - target.zero) / target.factor


def convert_difference(difference: float, unit: str, to: str) -> float:
    """Convert a difference of two values from ``unit`` to ``to``, ignoring the offsets of scales.

    Raises ValueError when the two units measure different things.
    """
    source, target = _both(unit, to)
    return difference if unit == to else difference * source.factor / target.factor


def _both(unit: str, to: str) -> tuple[Unit, Unit]:
    source, target = UNITS[unit], UNITS[to]
    if source.dimension is not target.dimension:
        raise ValueError(f"cannot convert {unit} ({source.dimension}) to {to} ({target.dimension})")
    return source, target


class Quaternion(NamedTuple):
    """A rotation or an orientation, as a unit quaternion."""

    w: float
    x: float
    y: float
    z: float

    @property
    def inverse(self) -> Quaternion:
        """The inverse rotation."""
        return Quaternion(self.w, -self.x, -self.y, -self.z)

    def after(self, first: Quaternion) -> Quaternion:
        """Return the rotation that applies ``first`` and then this one: their product."""
        a, b, c, d = self
        w, x, y, z = first
        return Quaternion(
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        )

    def distance(self, other: Quaternion) -> float:
        """Return the angle between two orientations, in radians: 0 to π."""
        w, x, y, z = self.inverse.after(other)
        return 2.0 * math.atan2(math.hypot(x, y, z), abs(w))

    def rotated(self, vector: Sequence[float]) -> tuple[float, float, float]:
        """Return a vector of three numbers, rotated."""
        x, y, z = vector
        _, *parts = self.after(Quaternion(0.0, x, y, z)).after(self.inverse)
        return parts[0], parts[1], parts[2]


#: the two ways to write a quaternion
QUATERNION_ORDERS = ("wxyz", "xyzw")
#: sines below which two Euler angles turn about the same axis
_LOCKED = 1e-7


def is_euler_order(text: str) -> bool:
    """Return whether a text is an order of Euler angles: ``xyz`` for fixed axes, ``XYZ`` for turning ones."""
    axes = text.lower()
    same_case = text in (axes, axes.upper())
    return len(axes) == 3 and set(axes) <= set("xyz") and same_case and all(a != b for a, b in pairwise(axes))


def from_rotation_vector(vector: Sequence[float]) -> Quaternion:
    """Return the rotation about a vector by its length, in radians."""
    angle = math.hypot(*vector)
    if angle == 0.0:
        return Quaternion(1.0, 0.0, 0.0, 0.0)
    x, y, z = (math.sin(angle / 2) / angle * part for part in vector)
    return Quaternion(math.cos(angle / 2), x, y, z)


def to_rotation_vector(rotation: Quaternion) -> list[float]:
    """Return the rotation vector of up to half a turn, in radians."""
    w, *axis = rotation if rotation[0] >= 0 else tuple(-part for part in rotation)
    size = math.hypot(*axis)
    return [part * 2.0 * math.atan2(size, w) / size for part in axis] if size > 0 else [0.0, 0.0, 0.0]


def from_euler(angles: Sequence[float], order: str) -> Quaternion:
    """Return the rotation about three axes, in radians, in the order in which they are written."""
    found = Quaternion(1.0, 0.0, 0.0, 0.0)
    for axis, angle in zip(order, angles, strict=True):
        turn = from_rotation_vector([angle * (name == axis.lower()) for name in "xyz"])
        found = found.after(turn) if axis.isupper() else turn.after(found)
    return found


def to_euler(rotation: Quaternion, order: str) -> list[float]:
    """Return Euler angles of a rotation, in radians; if two axes coincide, the third angle is zero."""
    turning = order.isupper()
    i, j, k = (1 + "xyz".index(axis) for axis in (reversed(order.lower()) if turning else order))
    proper = i == k
    k = 6 - i - j if proper else k
    sign = (i - j) * (j - k) * (k - i) // 2
    w, q1, q2, q3 = rotation[0], rotation[i], rotation[j], rotation[k] * sign
    a, b, c, d = (w, q1, q2, q3) if proper else (w - q2, q1 + q3, q2 + w, q3 - q1)
    middle = 2.0 * math.atan2(math.hypot(c, d), math.hypot(a, b))
    half_sum, half_difference = math.atan2(b, a), math.atan2(d, c)
    if abs(middle) <= _LOCKED:
        first, third = 2.0 * half_sum, 0.0
    elif abs(middle - math.pi) <= _LOCKED:
        first, third = -2.0 * half_difference, 0.0
    else:
        first, third = half_sum - half_difference, half_sum + half_difference
    if not proper:
        third, middle = third * sign, middle - math.pi / 2
    found = [third, middle, first] if turning else [first, middle, third]
    return [math.remainder(angle, 2.0 * math.pi) for angle in found]


def apart(first: float, second: float, turn: float) -> float:
    """Return how far two angles about the same axis are apart, modulo a full ``turn``."""
    return abs(math.remainder(first - second, turn))


def to_quaternion(
    values: Any, kind: str, order: str | None, radians: Callable[[float], float]
) -> Quaternion | None:
    """Return the unit quaternion of an orientation in an API's notation; None if it is no orientation.

    Args:
        values: the numbers.
        kind: ``rotation_vector``, ``quaternion`` or ``euler``.
        order: of the parts of a quaternion, or of Euler angles.
        radians: turns an angle of the API into radians.
    """
    numbers = _numbers(values)
    if numbers is None or len(numbers) != (4 if kind == "quaternion" else 3):
        return None
    if kind == "rotation_vector":
        return from_rotation_vector([radians(number) for number in numbers])
    if kind == "euler":
        return from_euler([radians(number) for number in numbers], order or "")
    size = math.hypot(*numbers)
    if size == 0.0:
        return None
    a, b, c, d = (number / size for number in numbers)
    return Quaternion(d, a, b, c) if order == "xyzw" else Quaternion(a, b, c, d)


def to_values(
    rotation: Quaternion, kind: str, order: str | None, angle: Callable[[float], float]
) -> list[float]:
    """Return an orientation in an API's notation; ``angle`` turns radians into its unit."""
    if kind == "rotation_vector":
        return [angle(part) for part in to_rotation_vector(rotation)]
    if kind == "euler":
        return [angle(part) for part in to_euler(rotation, order or "")]
    w, x, y, z = rotation
    return [x, y, z, w] if order == "xyzw" else [w, x, y, z]


def _numbers(values: Any) -> list[float] | None:
    if hasattr(type(values), "tolist"):
        values = values.tolist()
    if not isinstance(values, list | tuple):
        return None
    if not all(isinstance(part, int | float) and math.isfinite(part) for part in values):
        return None
    return [float(part) for part in values]
