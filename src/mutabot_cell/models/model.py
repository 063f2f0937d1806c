"""What stands in the cell, as MJCF text."""

from __future__ import annotations

import math
from collections.abc import Mapping

import mujoco
import numpy as np

from mutabot_cell.geometry import Pose, rotation_from_euler
from mutabot_cell.scene import (
    BLUE_RGBA,
    FRICTION_ON_SILICONE,
    FRICTION_ON_STEEL,
    RED_RGBA,
    Box,
    Fixture,
    Mark,
    Scene,
)

from .options import HEAD, PHYSICS_STEP
from .robot import RobotModel

ROBOT_BODY = "robot"
"""Behind a robot's prefix, the name of the body that stands at its base."""

_GRIP_BRAKE = 1.8
_LANDING = "0.008 0.8"
"""Time constant (s) and damping ratio of what a box lands on: it rebounds with a tenth of its speed, as
cardboard does on rubber."""

_LOOKS = """
<visual>
  <headlight ambient="0.35 0.35 0.35" diffuse="0.35 0.35 0.35" specular="0.1 0.1 0.1"/>
  <global offwidth="1280" offheight="960"/>
  <quality shadowsize="4096" offsamples="8"/>
  <map znear="0.02" zfar="30"/>
</visual>
<asset>
  <texture type="skybox" builtin="gradient" rgb1="0.93 0.95 0.97" rgb2="0.70 0.76 0.82" width="64"
           height="384"/>
  <texture name="floor" type="2d" builtin="checker" rgb1="0.80 0.81 0.82" rgb2="0.75 0.76 0.78" width="128"
           height="128"/>
  <material name="floor" texture="floor" texrepeat="8 8" reflectance="0.04"/>
</asset>
"""


def _numbers(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def _halves(values: tuple[float, ...]) -> str:
    return _numbers(tuple(value / 2 for value in values))


def _fixture_xml(fixture: Fixture) -> str:
    return (
        f'<geom name="{fixture.name}" class="fixture" type="box" size="{_halves(fixture.size)}" '
        f'pos="{_numbers(fixture.centre)}" rgba="{_numbers(fixture.rgba)}"/>'
    )


def _legs_xml(fixture: Fixture) -> str:
    """Four legs to look at; nothing touches them."""
    (width, depth, height), (x, y, z) = fixture.size, fixture.centre
    half = (z - height / 2) / 2
    if half <= 0.05:
        return ""
    return "".join(
        f'<geom class="looks" type="box" size="0.025 0.025 {half}" rgba="0.42 0.43 0.45 1" '
        f'pos="{x + side * (width / 2 - 0.06)} {y + end * (depth / 2 - 0.06)} {half}"/>'
        for side in (-1, 1)
        for end in (-1, 1)
    )


def _mark_xml(mark: Mark) -> str:
    x, y, z = mark.centre
    return (
        f'<geom name="{mark.name}" class="looks" type="box" size="{_halves(mark.size)} 0.0005" '
        f'pos="{_numbers((x, y, z + 0.0002))}" rgba="{_numbers(mark.rgba)}"/>'
    )


def _box_xml(box: Box) -> str:
    x, y, z = box.position
    half = box.edge / 2
    yaw = math.radians(box.yaw) / 2
    rgba = RED_RGBA if box.colour == "red" else BLUE_RGBA
    return (
        f'<body name="{box.name}" pos="{_numbers((x, y, z + half))}" '
        f'quat="{math.cos(yaw)} 0 0 {math.sin(yaw)}">'
        f'<freejoint name="{box.name}"/>'
        f'<geom name="{box.name}" class="box" type="box" size="{half} {half} {half}" mass="{box.mass}" '
        f'priority="1" solref="{_LANDING}" solimp="0.95 0.99 0.001" '
        f'friction="{_friction(box, FRICTION_ON_STEEL)} 0.005 0.0001" rgba="{_numbers(rgba)}"/></body>'
    )


def _friction(box: Box, material: float) -> float:
    return material if box.friction is None else box.friction


def _surface_xml(box: Box, fixtures: tuple[Fixture, ...], robots: Mapping[str, RobotModel]) -> str:
    """Contacts of a box with each fixture: friction belongs to the pair of materials."""
    surfaces = [(fixture.name, fixture.friction) for fixture in fixtures]
    surfaces += [("floor", FRICTION_ON_STEEL)]
    surfaces += [(f"{prefix}pedestal", FRICTION_ON_STEEL) for prefix in robots if _stands(robots[prefix])]
    return "".join(
        f'<pair geom1="{name}" geom2="{box.name}" condim="3" solref="{_LANDING}" solimp="0.95 0.99 0.001" '
        f'friction="{_pair_friction(_friction(box, friction))}"/>'
        for name, friction in surfaces
    )


def _pair_friction(friction: float) -> str:
    return f"{friction} {friction} 0.005 0.0001 0.0001"


def _grip_xml(box: Box, pads: list[str]) -> str:
    # Stiffer than other contacts: what is gripped must turn with the fingers. As stiff as this, a falling box
    # would bounce, for numerical reasons.
    # Friction brakes slip by `_GRIP_BRAKE` of itself per step. MuJoCo's constraint leaves out how the contact
    # itself accelerates (J' v, about v²/r while the arm moves), so a part of it stays as slip: per step
    # (1 / brake - 1/2) J' v dt², which vanishes at 2, where slip would swing for ever.
    return "".join(
        f'<pair geom1="{pad}" geom2="{box.name}" condim="3" solref="0.004 1" solimp="0.95 0.99 0.001" '
        f'solreffriction="0 {-_GRIP_BRAKE / PHYSICS_STEP}" '
        f'friction="{_pair_friction(_friction(box, FRICTION_ON_SILICONE))}"/>'
        for pad in pads
    )


def _stands(robot: RobotModel) -> bool:
    """Whether its base is above the floor, on a pedestal."""
    return robot.base.z > 0.0


def _robot_xml(prefix: str, robot: RobotModel) -> str:
    """The pedestal, and the body to which the robot is attached."""
    base = robot.base
    x, y, half = base.x, base.y, base.z / 2
    pedestal = (
        f'<geom name="{prefix}pedestal" class="fixture" type="cylinder" size="0.09 {half}" '
        f'pos="{_numbers((x, y, half))}" rgba="0.33 0.35 0.38 1"/>'
    )
    return (pedestal if _stands(robot) else "") + (
        f'<body name="{prefix}{ROBOT_BODY}" pos="{_numbers((x, y, base.z))}" quat="{_quaternion(base)}"/>'
    )


def _quaternion(pose: Pose) -> str:
    quaternion = np.zeros(4)
    turned = rotation_from_euler(pose.theta_x, pose.theta_y, pose.theta_z)
    mujoco.mju_mat2Quat(quaternion, turned.flatten())
    return _numbers(tuple(quaternion.tolist()))


def cell_xml(scene: Scene, robots: Mapping[str, RobotModel]) -> str:
    """MJCF of what stands in the cell, with an empty body for each robot."""
    things = "".join(_fixture_xml(fixture) + _legs_xml(fixture) for fixture in scene.fixtures)
    things += "".join(_mark_xml(mark) for mark in scene.marks)
    things += "".join(_box_xml(box) for box in scene.boxes)
    pads = [
        prefix + pad for prefix, robot in robots.items() if robot.tool for pad in robot.tool.effector.pads
    ]
    contacts = "".join(
        _grip_xml(box, pads) + _surface_xml(box, scene.fixtures, robots) for box in scene.boxes
    )
    stands = "".join(_robot_xml(prefix, robot) for prefix, robot in robots.items())
    return f"""<mujoco model="cell">{HEAD}{_LOOKS}
<worldbody>
  <light pos="1.5 -1.5 4" dir="-0.3 0.35 -1" diffuse="0.55 0.55 0.55" castshadow="true"/>
  <geom name="floor" class="fixture" type="plane" size="4 4 0.1" material="floor"/>
  {stands}{things}
</worldbody>
<contact>{contacts}</contact>
</mujoco>"""
