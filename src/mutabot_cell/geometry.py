"""Poses and rotations, in plain numpy.

Euler angles follow Kinova's convention: R = Rz(theta_z) · Ry(theta_y) · Rx(theta_x).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Position:
    """A point in m, in the frame that the function returning it names."""

    x: float
    y: float
    z: float

    def __array__(self, dtype: object = None, copy: bool | None = None) -> Array:
        """Return the position as an array, shape (3,)."""
        return np.array([self.x, self.y, self.z])


@dataclass(frozen=True, slots=True)
class Pose:
    """A position in m and Euler angles in degrees, in the frame that the function returning it names."""

    x: float
    y: float
    z: float
    theta_x: float
    theta_y: float
    theta_z: float

    @property
    def position(self) -> Position:
        """The position without the angles."""
        return Position(self.x, self.y, self.z)


def pose_of(position: Array, rotation: Array) -> Pose:
    """Return the pose of a position, shape (3,), m, and a rotation matrix, shape (3, 3)."""
    x, y, z = position.tolist()
    return Pose(x, y, z, *euler_from_rotation(rotation))


def rotation_from_euler(theta_x: float, theta_y: float, theta_z: float) -> Array:
    """Return the rotation matrix, shape (3, 3), for Euler angles in degrees."""
    cx, cy, cz = (math.cos(math.radians(a)) for a in (theta_x, theta_y, theta_z))
    sx, sy, sz = (math.sin(math.radians(a)) for a in (theta_x, theta_y, theta_z))
    return np.array(
        [
            [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
            [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
            [-sy, cy * sx, cy * cx],
        ]
    )


def quaternion_from_euler(theta_x: float, theta_y: float, theta_z: float) -> Array:
    """Return the unit quaternion w, x, y, z, shape (4,), for Euler angles in degrees."""
    cx, cy, cz = (math.cos(math.radians(a) / 2) for a in (theta_x, theta_y, theta_z))
    sx, sy, sz = (math.sin(math.radians(a) / 2) for a in (theta_x, theta_y, theta_z))
    return np.array(
        [
            cx * cy * cz + sx * sy * sz,
            sx * cy * cz - cx * sy * sz,
            cx * sy * cz + sx * cy * sz,
            cx * cy * sz - sx * sy * cz,
        ]
    )


def euler_from_rotation(rotation: Array) -> tuple[float, float, float]:
    """Return the Euler angles in degrees, each in (-180, 180], of a rotation matrix of shape (3, 3)."""
    (r00, r01, _), (r10, r11, _), (r20, r21, r22) = rotation.tolist()
    sine_y = -r20
    if abs(sine_y) > 1.0 - 1e-12:  # gimbal lock: only theta_z - theta_x (or the sum) is defined
        theta_y = math.copysign(math.pi / 2, sine_y)
        return (0.0, math.degrees(theta_y), math.degrees(math.atan2(-r01, r11)))
    theta_x = math.atan2(r21, r22)
    theta_z = math.atan2(r10, r00)
    return (math.degrees(theta_x), math.degrees(math.asin(sine_y)), math.degrees(theta_z))


def rotation_vector(rotation: Array) -> Array:
    """Return axis times angle (rad), shape (3,), of a rotation matrix; the angle is in [0, pi]."""
    axis = np.array(
        [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
        ]
    )
    sine = 0.5 * float(np.linalg.norm(axis))
    cosine = 0.5 * (float(np.trace(rotation)) - 1.0)
    angle = math.atan2(sine, cosine)
    if sine > 1e-9:
        return axis * (angle / (2.0 * sine))
    if cosine > 0:
        return 0.5 * axis
    # half a turn: the axis is the column of R + I that is longest
    columns = rotation + np.eye(3)
    longest = columns[:, int(np.argmax(np.linalg.norm(columns, axis=0)))]
    result: Array = longest / np.linalg.norm(longest) * angle
    return result


def rotation_about(vector: Array) -> Array:
    """Return the rotation matrix, shape (3, 3), of a rotation vector, axis times angle (rad), shape (3,)."""
    angle = float(np.linalg.norm(vector))
    if angle < 1e-12:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    result: Array = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * (cross @ cross)
    return result
