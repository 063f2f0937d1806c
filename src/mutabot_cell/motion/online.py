"""Motions decided tick by tick: from a wanted tool pose to joint setpoints, within the joints' limits."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from mutabot_cell.errors import PathLost
from mutabot_cell.geometry import Array, rotation_vector
from mutabot_cell.models.robot import RobotModel

from .kinematics import LIMIT_MARGIN, Kinematics
from .trajectory import Motion

_POSITION_TOLERANCE = 1e-6
_ROTATION_TOLERANCE = 1e-5
_LARGEST_ERROR = 1e-3
_ITERATIONS = 4
_DAMPING = 1e-8 * np.eye(6)
"""Of the least squares, m² per rad²: far below the squared singular values where joints keep their limits."""


class OnlineMotion(Protocol):
    """A motion that the arm asks for setpoints at the beginning of each control tick."""

    def tick(self) -> Motion | None:
        """Return the setpoints of the coming tick, one row per physics step; None when the motion has ended.

        Raises:
            PathLost: the next pose cannot be reached within the joints' limits.
        """
        ...


class JointSteps:
    """The joint setpoints for tool poses that are known one tick ahead.

    Inverse kinematics by Newton steps with the pseudo-inverse of the last tick's Jacobian (damped least
    squares), from where the joints will be if they go on: a tick's way is so short that one or two do. Of the
    joint motions that give the wanted pose it is the smallest.

    Args:
        kinematics: the controller's model of the arm.
        robot: whose limits hold.
        joints: where the joints are, at rest, shape (joints,), rad.
        steps: physics steps in a tick.
        step: length of one, s.
    """

    def __init__(
        self, kinematics: Kinematics, robot: RobotModel, joints: Array, steps: int, step: float
    ) -> None:
        self._kinematics = kinematics
        self.limits = robot.limits
        self._bounds = _Bounds(robot)
        self.joints: Array = joints.copy()
        self.speeds: Array = np.zeros_like(joints)
        self.accelerations: Array = np.zeros_like(joints)
        u = np.arange(1, steps + 1) / steps
        # cubic Hermite interpolation: of the way, the speed at its start and at its end
        value = np.stack((3 * u**2 - 2 * u**3, u**3 - 2 * u**2 + u, u**3 - u**2), axis=1)
        rate = np.stack((6 * (u - u**2), 3 * u**2 - 4 * u + 1, 3 * u**2 - 2 * u), axis=1)
        self._hermite: Array = np.stack((value, rate))
        self._tick = steps * step
        kinematics.tool(joints)
        self._inverse = self._inverted()

    def tool(self) -> tuple[Array, Array]:
        """Return the tool's commanded position, shape (3,), m, and rotation, shape (3, 3)."""
        return self._kinematics.tool(self.joints)

    def towards(self, position: Array, rotation: Array, velocity: Array) -> Motion:
        """Return the setpoints of a tick at whose end the tool is there.

        Args:
            position: shape (3,), m.
            rotation: shape (3, 3).
            velocity: of the tool at that time, m/s and rad/s in the base frame, shape (6,).

        Raises:
            PathLost: a joint would exceed a limit, or no joint angles lead there.
        """
        joints = self._solve(position, rotation)
        self._inverse = self._inverted()
        speeds = self._inverse @ velocity
        accelerations = (speeds - self.speeds) / self._tick
        self._bounds.check(joints, speeds, accelerations)
        motion = self._between(joints, speeds)
        self.joints, self.speeds, self.accelerations = joints, speeds, accelerations
        return motion

    def _solve(self, position: Array, rotation: Array) -> Array:
        joints = self.joints + self.speeds * self._tick
        for _ in range(_ITERATIONS):
            at, turned = self._kinematics.tool(joints)
            shift = position - at
            turn = turned @ rotation_vector(turned.T @ rotation)
            away, angle = math.sqrt(shift @ shift), math.sqrt(turn @ turn)
            if away < _POSITION_TOLERANCE and angle < _ROTATION_TOLERANCE:
                return joints
            joints = joints + self._inverse @ np.concatenate((shift, turn))
        if away > _LARGEST_ERROR:
            raise PathLost(
                f"the tool cannot follow: it would stay {away * 1000:.0f} mm behind, at the end of its reach",
                limit="reach",
                excess=away,
                unit="m",
            )
        return joints

    def _inverted(self) -> Array:
        """Return the pseudo-inverse of the Jacobian at the joints solved for last, shape (joints, 6)."""
        jacobian = self._kinematics.jacobian()
        inverse: Array = jacobian.T @ np.linalg.inv(jacobian @ jacobian.T + _DAMPING)
        return inverse

    def _between(self, joints: Array, speeds: Array) -> Motion:
        """Return the setpoints of the physics steps from the present joints to these."""
        width = self._tick
        way = joints - self.joints
        start, end = self.speeds * width, speeds * width
        values, rates = self._hermite @ np.stack((way, start, end))
        return Motion(self.joints + values, rates / width)


class _Bounds:
    """The limits of a robot's joints, as arrays."""

    def __init__(self, robot: RobotModel) -> None:
        self._speed, self._acceleration = np.array(robot.limits.speed), np.array(robot.limits.acceleration)
        self._jerk = np.array(robot.limits.jerk)
        lowest, highest = np.array(robot.ranges).T
        self._lowest, self._highest = lowest + LIMIT_MARGIN, highest - LIMIT_MARGIN

    def check(self, joints: Array, speeds: Array, accelerations: Array) -> None:
        """Raise PathLost if the joints are too fast, or could not stop within their angles."""
        pace, gain = np.abs(speeds), np.abs(accelerations)
        for what, values, most in (("speed", pace, self._speed), ("acceleration", gain, self._acceleration)):
            over = values - most
            worst = int(np.argmax(over))
            if over[worst] > 0:
                raise _lost(worst, what, float(values[worst]), float(most[worst]))
        # Not more than a joint needs to rest, under its limits: first its acceleration fades, then it brakes.
        fading = gain / self._jerk
        fastest = pace + gain * fading / 2
        braking = fastest * (fastest / self._acceleration + self._acceleration / self._jerk) / 2
        ends = joints + np.sign(speeds) * (fading * (pace + gain * fading / 3) + braking)
        over = np.maximum(ends - self._highest, self._lowest - ends)
        worst = int(np.argmax(over))
        if over[worst] > 0:
            allowed = self._highest if ends[worst] > self._highest[worst] else self._lowest
            raise _lost(worst, "angle", float(ends[worst]), float(allowed[worst]))


_UNITS = {"speed": "deg/s", "acceleration": "deg/s²", "angle": "deg"}


def _lost(joint: int, what: str, value: float, allowed: float) -> PathLost:
    value, allowed, unit = math.degrees(value), math.degrees(allowed), _UNITS[what]
    excess = abs(value - allowed)
    need = "would come to rest at" if what == "angle" else "would need"
    return PathLost(
        f"the tool cannot follow: joint {joint + 1} {need} {value:.1f} {unit}, {excess:.1f} {unit} "
        f"beyond its limit of {allowed:.1f} {unit}",
        limit=f"joint {joint + 1} {what}",
        value=value,
        allowed=allowed,
        excess=excess,
        unit=unit,
    )
