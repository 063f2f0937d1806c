"""Plans motions along lines and between joint angles; plans are shared within a campaign."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import numpy as np

from mutabot.api.processes import SharedMemory
from mutabot_cell.geometry import Array
from mutabot_cell.integrity import MOTIONS, are_original
from mutabot_cell.models.options import PHYSICS_STEP
from mutabot_cell.models.robot import RobotModel

from .kinematics import Kinematics
from .line import Line
from .rounded_path import RoundedPath
from .trajectory import Motion, joint_motion, line_motion


class Planner:
    """Plans motions of one robot, sampled at every physics step."""

    def __init__(self, robot: RobotModel, kinematics: Kinematics) -> None:
        self._limits, self._tool_limits = robot.limits, robot.tool_limits
        self._kinematics = kinematics
        self._memory = SharedMemory.current()
        self._robot = b""
        if self._memory is not None:
            numbers = robot.limits, robot.tool_limits, robot.reach
            self._robot = kinematics.fingerprint() + repr(numbers).encode()

    def along(self, joints: Array, line: Line | RoundedPath, speed: float) -> Motion:
        """Return a motion of the tool along a line or path.

        Args:
            joints: where it starts, shape (joints,), rad.
            line: to follow.
            speed: part of the tool's speed limits, 0..1.

        Raises:
            MotionRefused: some point of the line is out of reach or limits.
        """

        def plan() -> Motion:
            knots = self._kinematics.follow(joints, line)
            limits = self._limits, self._tool_limits
            return line_motion(knots, line.length, line.angle, PHYSICS_STEP, *limits, speed)

        return self._remembered(plan, joints, *line.numbers, speed)

    def between(self, start: Array, end: Array, speed: float) -> Motion:
        """Return the fastest motion between two joint positions, shape (joints,) each, rad.

        Args:
            start, end: of the motion.
            speed: part of the joints' speed limits, 0..1.
        """

        def plan() -> Motion:
            return joint_motion(start, end, PHYSICS_STEP, self._limits, speed)

        return self._remembered(plan, start, end, speed)

    def _remembered(self, plan: Callable[[], Motion], *given: Array | float) -> Motion:
        """Return what `plan` makes of these arguments, from memory if possible."""
        if self._memory is None or not are_original(MOTIONS, self, self._kinematics):
            return plan()
        numbers = np.concatenate([np.ravel(part) for part in given])
        key = hashlib.sha256(self._robot + numbers.tobytes()).digest()[: SharedMemory.key_size]
        kept = self._memory.get(key)
        if kept is not None:
            return Motion(*np.frombuffer(kept).reshape(2, -1, self._kinematics.count))
        motion = plan()
        if are_original(MOTIONS, self, self._kinematics):
            self._memory.put(key, motion.joints.tobytes() + motion.speeds.tobytes())
        return motion
