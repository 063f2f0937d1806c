"""Frames: a position in m and a rotation as a unit quaternion, w first."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

Vector = tuple[float, float, float]
UnitQuaternion = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Frame:
    """Where something is in a frame, and how it is turned there."""

    position: Vector = (0.0, 0.0, 0.0)
    rotation: UnitQuaternion = (1.0, 0.0, 0.0, 0.0)

    @classmethod
    def of_euler(cls, position: Sequence[float], z: float, y: float, x: float) -> Frame:
        """Return the frame of Euler angles in degrees: R = Rz·Ry·Rx."""
        (cz, sz), (cy, sy), (cx, sx) = (
            (math.cos(math.radians(angle) / 2), math.sin(math.radians(angle) / 2)) for angle in (z, y, x)
        )
        rotation = (
            cx * cy * cz + sx * sy * sz,
            sx * cy * cz - cx * sy * sz,
            cx * sy * cz + sx * cy * sz,
            cx * cy * sz - sx * sy * cz,
        )
        return cls(vector_of(position), rotation)

    @classmethod
    def of_vector(cls, position: Sequence[float], vector: Sequence[float]) -> Frame:
        """Return the frame of a rotation vector: axis times angle, rad."""
        angle = math.hypot(*vector)
        if angle < 1e-12:
            return cls(vector_of(position))
        factor = math.sin(angle / 2) / angle
        x, y, z = vector
        return cls(vector_of(position), (math.cos(angle / 2), x * factor, y * factor, z * factor))

    @classmethod
    def of_quaternion(cls, position: Sequence[float], rotation: Sequence[float]) -> Frame:
        """Return the frame of a quaternion of any length. Raises ValueError if it is 0."""
        length = math.hypot(*rotation)
        if length < 1e-9:
            raise ValueError("a quaternion of zeros is no rotation")
        w, x, y, z = (part / length for part in rotation)
        return cls(vector_of(position), (w, x, y, z))

    def __mul__(self, other: Frame) -> Frame:
        """Return what stands at ``other`` in this frame, seen from where this frame is given."""
        shift = self.turn(other.position)
        (x, y, z), (a, b, c) = self.position, shift
        return Frame((x + a, y + b, z + c), _product(self.rotation, other.rotation))

    def inverse(self) -> Frame:
        """Return the frame that takes this one back."""
        w, x, y, z = self.rotation
        back = Frame(rotation=(w, -x, -y, -z))
        a, b, c = back.turn(self.position)
        return Frame((-a, -b, -c), back.rotation)

    def turn(self, vector: Sequence[float]) -> Vector:
        """Return a direction of this frame, seen from where this frame is given."""
        w, x, y, z = self.rotation
        a, b, c = vector
        # v + 2w (q × v) + 2 q × (q × v)
        d, e, f = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
        return (a + w * d + y * f - z * e, b + w * e + z * d - x * f, c + w * f + x * e - y * d)

    def euler(self) -> tuple[float, float, float]:
        """Return Euler angles z, y, x in degrees, as ``of_euler`` takes them."""
        w, x, y, z = self.rotation
        sine = max(-1.0, min(1.0, 2 * (w * y - z * x)))
        if abs(sine) > 1 - 1e-12:
            return math.degrees(math.atan2(-2 * (x * y - w * z), 1 - 2 * (x * x + z * z))), 90.0 * sine, 0.0
        return (
            math.degrees(math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))),
            math.degrees(math.asin(sine)),
            math.degrees(math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))),
        )

    def vector(self) -> Vector:
        """Return the rotation vector: axis times angle, rad, of the shorter way."""
        w, x, y, z = self.rotation if self.rotation[0] >= 0 else tuple(-part for part in self.rotation)
        sine = math.hypot(x, y, z)
        if sine < 1e-12:
            return (0.0, 0.0, 0.0)
        factor = 2 * math.atan2(sine, w) / sine
        return (x * factor, y * factor, z * factor)

    def between(self, other: Frame, fraction: float) -> Frame:
        """Return the frame at a part of the way to another one."""
        step = self.inverse() * other
        turn = tuple(part * fraction for part in step.vector())
        shift = tuple(part * fraction for part in step.position)
        return self * Frame.of_vector(shift, turn)

    def distance(self, other: Frame) -> float:
        """Return the distance between the positions, m."""
        return math.dist(self.position, other.position)


IDENTITY = Frame()


def vector_of(values: Sequence[float]) -> Vector:
    """Return three numbers as a vector."""
    x, y, z = (float(value) for value in values)
    return (x, y, z)


def cross(a: Sequence[float], b: Sequence[float]) -> Vector:
    """Return the cross product of two vectors."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _product(first: UnitQuaternion, second: UnitQuaternion) -> UnitQuaternion:
    a, b, c, d = first
    w, x, y, z = second
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )
