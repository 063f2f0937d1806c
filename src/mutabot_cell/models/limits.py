"""Limits of joints and tool: those that a user sets, and the resulting ones of each joint.

Angles in rad, lengths in m, torques in Nm.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import zip_longest

from mutabot_cell.errors import BadArgument, BadModel


@dataclass(frozen=True, slots=True)
class JointLimits:
    """The limits of joints, one value per joint.

    Attributes:
        speed: rad/s.
        acceleration: rad/s².
        jerk: rad/s³.
        torque: what the joint can give without end, Nm.
        peak_torque: what it can give for a short time, Nm.
        external_torque: torque from outside that stops the arm when it lasts two ticks, Nm.
        following_error: distance between setpoint and joint that stops the arm, rad; one for all joints.
    """

    speed: tuple[float, ...]
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...]
    torque: tuple[float, ...]
    peak_torque: tuple[float, ...]
    external_torque: tuple[float, ...]
    following_error: float = 0.03


Each = float | Sequence[float]
"""One value for all joints, or one for each."""


@dataclass(frozen=True, slots=True)
class Limits:
    """The limits that a user sets for joints: one value for all, one for each, or None.

    Attributes:
        speed: rad/s; 1 rad/s by default.
        acceleration: rad/s²; five times the speed by default.
        jerk: rad/s³; ten times the acceleration by default.
        torque: what a joint can give without end, Nm; the peak torque by default.
        peak_torque: what a joint can give for a short time, Nm; what the file says, else the torque.
        external_torque: torque from outside that stops the arm, Nm; half of the torque by default.
        following_error: distance between setpoint and joint that stops the arm, rad.
    """

    speed: Each = 1.0
    acceleration: Each | None = None
    jerk: Each | None = None
    torque: Each | None = None
    peak_torque: Each | None = None
    external_torque: Each | None = None
    following_error: float = 0.03

    def of_joints(self, joints: Sequence[str], found: Sequence[float | None]) -> JointLimits:
        """Return each joint's limits.

        Args:
            joints: their names.
            found: the torque (Nm) that the file allows each joint, if it says so.

        Raises:
            BadModel: neither file nor limits say what torque a joint has.
            BadArgument: not one value per joint, or one that is not above 0.
        """
        count = len(joints)
        speed = _each("speed", self.speed, count)
        acceleration = _each("acceleration", self.acceleration, count, [5 * value for value in speed])
        torque = _each("torque", self.torque, count)
        torques = [first or second for first, second in zip_longest(found, torque)]
        if self.peak_torque is None and None in torques:
            raise BadModel(
                f"joint {joints[torques.index(None)]!r} has no actuator with a known torque: add one with a "
                "forcerange (Nm), or say Limits(torque=...)"
            )
        peak = _each("peak_torque", self.peak_torque, count, [value or 0.0 for value in torques])
        torque = torque or peak
        return JointLimits(
            speed=speed,
            acceleration=acceleration,
            jerk=_each("jerk", self.jerk, count, [10 * value for value in acceleration]),
            torque=torque,
            peak_torque=peak,
            external_torque=_each(
                "external_torque", self.external_torque, count, [value / 2 for value in torque]
            ),
            following_error=self.following_error,
        )


def _each(name: str, value: Each | None, count: int, other: Sequence[float] = ()) -> tuple[float, ...]:
    if value is None:
        return tuple(other)
    values = (float(value),) * count if isinstance(value, (int, float)) else tuple(map(float, value))
    if len(values) != count or not all(value > 0 for value in values):
        raise BadArgument(f"Expected {count} values > 0, or one, but got {name}={value!r}")
    return values


@dataclass(frozen=True, slots=True)
class ToolLimits:
    """Speed, acceleration and jerk of the tool on a straight line: m, rad, s. The values are our choice."""

    speed: float = 0.5
    turn_speed: float = math.radians(60.0)
    acceleration: float = 2.0
    turn_acceleration: float = math.radians(240.0)
    jerk: float = 20.0
    turn_jerk: float = math.radians(2400.0)
