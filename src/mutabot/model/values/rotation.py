"""Orientations: rotation vectors, quaternions and Euler angles, and how far two of them are apart.

Everything goes through unit quaternions (w, x, y, z). Two orientations are as far apart as the angle of the
one rotation that leads from the first to the second, between 0 and half a turn: 2·atan2(|v|, |w|) of the
quaternion between them. Euler angles are read out after Bernardes and Viollet, "Quaternion to Euler angles
conversion: A direct, general and computationally efficient method", PLoS ONE 17 (2022) e0276302.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

Quaternion = tuple[float, float, float, float]

#: the two ways to write a quaternion
QUATERNION_ORDERS = ("wxyz", "xyzw")
#: sines below which two Euler angles turn about the same axis
_LOCKED = 1e-7


def is_euler_order(text: str) -> bool:
    """Whether these are axes of Euler angles: ``xyz`` if the axes stay, ``XYZ`` if they turn along."""
    axes = text.lower()
    same_case = text in (axes, axes.upper())
    return len(axes) == 3 and set(axes) <= set("xyz") and same_case and all(a != b for a, b in pairwise(axes))


def product(first: Quaternion, second: Quaternion) -> Quaternion:
    """The rotation that does the second, then the first."""
    a, b, c, d = first
    w, x, y, z = second
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def inverse(rotation: Quaternion) -> Quaternion:
    """The rotation back."""
    w, x, y, z = rotation
    return (w, -x, -y, -z)


def distance(first: Quaternion, second: Quaternion) -> float:
    """Angle between two orientations, in radians: 0 to π."""
    w, x, y, z = product(inverse(first), second)
    return 2.0 * math.atan2(math.hypot(x, y, z), abs(w))


def from_rotation_vector(vector: Sequence[float]) -> Quaternion:
    """The rotation about a vector by its length, in radians."""
    angle = math.hypot(*vector)
    if angle == 0.0:
        return (1.0, 0.0, 0.0, 0.0)
    x, y, z = (math.sin(angle / 2) / angle * part for part in vector)
    return (math.cos(angle / 2), x, y, z)


def to_rotation_vector(rotation: Quaternion) -> list[float]:
    """The rotation vector of up to half a turn, in radians."""
    w, *axis = rotation if rotation[0] >= 0 else tuple(-part for part in rotation)
    size = math.hypot(*axis)
    return [part * 2.0 * math.atan2(size, w) / size for part in axis] if size > 0 else [0.0, 0.0, 0.0]


def from_euler(angles: Sequence[float], order: str) -> Quaternion:
    """The rotation about three axes, in radians, in the order in which they are written."""
    found: Quaternion = (1.0, 0.0, 0.0, 0.0)
    for axis, angle in zip(order, angles, strict=True):
        turn = from_rotation_vector([angle * (name == axis.lower()) for name in "xyz"])
        found = product(found, turn) if axis.isupper() else product(turn, found)
    return found


def to_euler(rotation: Quaternion, order: str) -> list[float]:
    """Euler angles of a rotation, in radians; where two axes fall together the third angle is zero."""
    turning = order.isupper()
    i, j, k = (1 + "xyz".index(axis) for axis in (reversed(order.lower()) if turning else order))
    proper = i == k
    k = 6 - i - j if proper else k
    sign = (i - j) * (j - k) * (k - i) // 2
    w, one, two, three = rotation[0], rotation[i], rotation[j], rotation[k] * sign
    a, b, c, d = (w, one, two, three) if proper else (w - two, one + three, two + w, three - one)
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
    """How far two angles about the same axis are apart, where a full ``turn`` makes no difference."""
    return abs(math.remainder(first - second, turn))


def to_quaternion(
    values: Any, kind: str, order: str | None, radians: Callable[[float], float]
) -> Quaternion | None:
    """The unit quaternion of an orientation as an API writes it; None if these numbers are none.

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
    return (d, a, b, c) if order == "xyzw" else (a, b, c, d)


def to_values(
    rotation: Quaternion, kind: str, order: str | None, angle: Callable[[float], float]
) -> list[float]:
    """An orientation as an API writes it; ``angle`` turns radians into its unit."""
    if kind == "rotation_vector":
        return [angle(part) for part in to_rotation_vector(rotation)]
    if kind == "euler":
        return [angle(part) for part in to_euler(rotation, order or "")]
    w, x, y, z = rotation
    return [x, y, z, w] if order == "xyzw" else [w, x, y, z]


def _numbers(values: Any) -> list[float] | None:
    if hasattr(values, "tolist"):
        values = values.tolist()
    if not isinstance(values, list | tuple):
        return None
    if not all(isinstance(part, int | float) and math.isfinite(part) for part in values):
        return None
    return [float(part) for part in values]
