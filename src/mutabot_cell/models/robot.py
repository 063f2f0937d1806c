"""A robot as plain data for planner, controller, sensors and the physics' model.

Lengths in m, angles in rad, torques in Nm, masses in kg.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from os import PathLike

from mutabot_cell.errors import BadArgument
from mutabot_cell.geometry import Pose
from mutabot_cell.scene import BASE_POSITION

from .limits import Limits, ToolLimits
from .loading import ArmModel, read_mjcf
from .tool import Tool
from .urdf import read_urdf

ON_PEDESTAL = Pose(*BASE_POSITION, 0.0, 0.0, 0.0)
"""Where a base stands unless said otherwise: on a pedestal as high as the published experiment's."""


@dataclass(frozen=True, slots=True)
class SphericalWrist:
    """The arm's reach in closed form, if its last axes meet in one point, the wrist.

    Attributes:
        shoulder: base frame, m.
        length: largest distance between shoulder and wrist, m.
        to_flange: from the wrist to the flange along the flange's z axis, m.
    """

    shoulder: tuple[float, float, float]
    length: float
    to_flange: float


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RobotModel(ArmModel):
    """An arm, and the tool at its flange.

    Attributes, beside those of the arm:
        base: where the base stands in the world, m and degrees.
        tool_limits: what the tool may do.
        payload: what the arm is rated for without a gripper, kg.
        tool: what is fastened to the flange, if anything.
        reach: its reach in closed form, for refusals that say by how much; None: the planner finds out.
        is_fed_forward: whether the controller gives servos the torques that a motion needs: servos of files
            can be too soft to follow without.
    """

    base: Pose = ON_PEDESTAL
    tool_limits: ToolLimits
    payload: float
    tool: Tool | None = None
    reach: SphericalWrist | None = None
    is_fed_forward: bool = False

    @classmethod
    def from_mjcf(
        cls,
        path: str | PathLike[str],
        *,
        tool_site: str,
        home: Sequence[float] | None = None,
        limits: Limits | None = None,
        tool_limits: ToolLimits | None = None,
        payload: float = 1.0,
        root: str | None = None,
        without: Sequence[str] = (),
    ) -> RobotModel:
        """Return a robot from a file in MuJoCo's format.

        Servos are those of the file if all joints have position servos; else they are made from the limits.
        Gravity is compensated, as controllers do. The arm's parts do not collide with each other.

        Args:
            path: of the file.
            tool_site: name of the site, or body, to whose frame tools are fastened; z points out.
            home: joint angles, degrees; by default those of the file's keyframe "home", or of its first.
            limits: of joints and tool; see `Limits` and `ToolLimits` for what is assumed.
            tool_limits: how fast the tool may be on a straight line.
            payload: what the arm is rated for without a gripper, kg.
            root: name of the robot's first body, in a file that holds other things too. Its frame is then the
                base frame, and the base stands where this body stands; else the file's world is the base.
            without: names of bodies and shapes to leave out, such as a gripper that is part of the file.

        Raises:
            BadModel: the file lacks something; the message says what to add.
            BadArgument: an argument does not fit it.
        """
        arm = read_mjcf(path, tool_site, home, limits or Limits(), root, without)
        return cls._of(arm, tool_limits, payload)

    @classmethod
    def from_urdf(
        cls,
        path: str | PathLike[str],
        *,
        tool_link: str,
        home: Sequence[float],
        limits: Limits | None = None,
        tool_limits: ToolLimits | None = None,
        payload: float = 1.0,
        packages: Mapping[str, str | PathLike[str]] | None = None,
    ) -> RobotModel:
        """Return a robot from a URDF. Its servos are made from the limits; see `from_mjcf` for the rest.

        Args:
            path: of the file.
            tool_link: name of the link to whose frame tools are fastened; z points away from the arm.
            home: joint angles, degrees.
            packages: folders of packages, for `package://NAME/...` in names of meshes.
        """
        arm = read_urdf(path, tool_link, home, limits or Limits(), packages or {})
        return cls._of(arm, tool_limits, payload)

    @classmethod
    def _of(cls, arm: ArmModel, tool_limits: ToolLimits | None, payload: float) -> RobotModel:
        values = {field.name: getattr(arm, field.name) for field in fields(ArmModel)}
        values["base"] = arm.base or ON_PEDESTAL
        return cls(**values, tool_limits=tool_limits or ToolLimits(), payload=payload, is_fed_forward=True)

    def with_tool(self, tool: Tool | None) -> RobotModel:
        """Return the arm with `tool` at its flange; None for an arm alone."""
        return replace(self, tool=tool)

    def with_home(self, angles: Sequence[float]) -> RobotModel:
        """Return the robot with another home position, in which a cell begins: joint angles, degrees."""
        if len(angles) != len(self.joints):
            raise BadArgument(f"Expected {len(self.joints)} joint angles but got angles={angles!r}")
        return replace(self, home=tuple(math.radians(angle) for angle in angles))

    def at(self, base: Pose) -> RobotModel:
        """Return the robot with its base at `base`: world frame, m and degrees."""
        return replace(self, base=base)
