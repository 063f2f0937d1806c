"""Reach in closed form, by the distance of the wrist from the shoulder, for arms with a spherical wrist."""

from __future__ import annotations

import math

import mujoco
import numpy as np

from mutabot_cell.errors import MotionRefused
from mutabot_cell.geometry import Array
from mutabot_cell.models.robot import RobotModel, SphericalWrist

from .line import Line
from .rounded_path import RoundedPath

_CHECKS = 41


class WristReach:
    """The reach of an arm with its tool; unlimited if unknown (`RobotModel.reach`).

    Attributes:
        length: largest distance between shoulder and wrist, m.
    """

    def __init__(self, robot: RobotModel) -> None:
        wrist = robot.reach or SphericalWrist((0.0, 0.0, 0.0), math.inf, 0.0)
        self.length = wrist.length
        self._shoulder = np.array(wrist.shoulder)
        flange = np.array((0.0, 0.0, -wrist.to_flange))
        self._wrist = flange  # in the tool's frame
        if robot.tool is not None:
            back = np.zeros(4)
            mujoco.mju_negQuat(back, np.array(robot.tool.turn))
            self._wrist = np.zeros(3)
            mujoco.mju_rotVecQuat(self._wrist, flange - np.array(robot.tool.point), back)

    def distance(self, position: Array, rotation: Array) -> float:
        """Return the distance between shoulder and wrist, m.

        Args:
            position: of the tool, shape (3,), m.
            rotation: of the tool, shape (3, 3).
        """
        return float(np.linalg.norm(position + rotation @ self._wrist - self._shoulder))

    def check(self, line: Line | RoundedPath) -> None:
        """Refuse a line or path on which the wrist would be further from the shoulder than the arm's length.

        Raises:
            MotionRefused: the limit is "reach".
        """
        if line.is_straight:  # the wrist goes straight, so it is farthest at one of the ends
            ends = (self.distance(line.position_at(part), line.rotation) for part in (0.0, 1.0))
            if max(ends) <= self.length:
                return
        fractions = np.linspace(0.0, 1.0, _CHECKS).tolist()
        distances = [self.distance(line.position_at(part), line.rotation_at(part)) for part in fractions]
        farthest, length = max(distances), self.length
        if farthest <= length:
            return
        fraction = next(part for part, away in zip(fractions, distances, strict=True) if away > length)
        raise MotionRefused(
            f"out of reach from {fraction:.0%} of the line: the wrist would be "
            f"{farthest:.3f} m from the shoulder, {(farthest - length) * 1000:.0f} mm more than the arm's "
            f"{length:.3f} m",
            limit="reach",
            value=farthest,
            allowed=length,
            excess=farthest - length,
            unit="m",
            fraction=fraction,
        )
