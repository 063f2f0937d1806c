"""A robot as plain data: what planner, controller, sensors and the physics' model ask about an arm.

Lengths in m, angles in rad, torques in Nm, masses in kg.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import mujoco

from mutabot_cell.geometry import Pose
from mutabot_cell.scene import BASE_POSITION

from .tool import Tool

ON_PEDESTAL = Pose(*BASE_POSITION, 0.0, 0.0, 0.0)
"""Where a base stands unless said otherwise: on a pedestal as high as the published experiment's."""


@dataclass(frozen=True, slots=True)
class JointLimits:
    """What each joint may do, one value per joint.

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


@dataclass(frozen=True, slots=True)
class ToolLimits:
    """How fast the tool may move on a straight line: m, rad, s. The values are our choice."""

    speed: float = 0.5
    turn_speed: float = math.radians(60.0)
    acceleration: float = 2.0
    turn_acceleration: float = math.radians(240.0)
    jerk: float = 20.0
    turn_jerk: float = math.radians(2400.0)


@dataclass(frozen=True, slots=True)
class SphericalWrist:
    """Reach in closed form, for arms whose last axes meet in one point, the wrist.

    Attributes:
        shoulder: base frame, m.
        length: largest distance between shoulder and wrist, m.
        to_flange: from the wrist to the flange along the flange's z axis, m.
    """

    shoulder: tuple[float, float, float]
    length: float
    to_flange: float


@dataclass(frozen=True, slots=True, eq=False)
class RobotModel:
    """An arm, and the tool at its flange.

    Attributes:
        name: of the robot's type.
        spec: the arm without a tool; its world frame is the robot's base frame.
        joints: names of the joints from the base to the flange; each turns about one axis.
        servos: names of the position servos of these joints.
        home: joint angles of the home position, rad.
        ranges: lowest and highest angle of each joint, rad; infinite for one that turns without end.
        limits, tool_limits: what joints and tool may do.
        flange: name of the site to which tools are fastened; its z axis points away from the arm.
        payload: what the arm is rated for without a gripper, kg.
        base: where the base stands in the world, m and degrees.
        tool: what is fastened to the flange, if anything.
        reach: its reach in closed form, for refusals that say by how much; None: the planner finds out.
    """

    name: str
    spec: mujoco.MjSpec
    joints: tuple[str, ...]
    servos: tuple[str, ...]
    home: tuple[float, ...]
    ranges: tuple[tuple[float, float], ...]
    limits: JointLimits
    tool_limits: ToolLimits
    flange: str
    payload: float
    base: Pose = ON_PEDESTAL
    tool: Tool | None = None
    reach: SphericalWrist | None = None

    def with_tool(self, tool: Tool) -> RobotModel:
        """The same arm with `tool` at its flange."""
        return replace(self, tool=tool)

    def at(self, base: Pose) -> RobotModel:
        """The same robot with its base at `base`: world frame, m and degrees."""
        return replace(self, base=base)
