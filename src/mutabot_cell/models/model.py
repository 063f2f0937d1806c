"""What stands in the cell, as MJCF text."""

from __future__ import annotations

from collections.abc import Mapping

from mutabot_cell.geometry import quaternion_from_euler
from mutabot_cell.scene import Fixture, Mark, Scene

from .options import HEAD
from .robot import RobotModel

ROBOT_BODY = "robot"
"""Behind a robot's prefix, the name of the body that stands at its base."""

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


def _quaternion(theta_x: float, theta_y: float, theta_z: float) -> str:
    return _numbers(tuple(quaternion_from_euler(theta_x, theta_y, theta_z).tolist()))


def _fixture_xml(fixture: Fixture) -> str:
    """A body of its own, so that it can be moved; bodies of fixtures come before those of robots."""
    return (
        f'<body name="{fixture.name}" pos="{_numbers(fixture.centre)}" quat="{_quaternion(*fixture.angles)}">'
        f'<geom name="{fixture.name}" class="fixture" type="box" size="{_halves(fixture.size)}" '
        f'rgba="{_numbers(fixture.rgba)}"/>{_legs_xml(fixture)}</body>'
    )


def _legs_xml(fixture: Fixture) -> str:
    """Four legs to look at; nothing touches them."""
    width, depth, height = fixture.size
    below = fixture.centre[2] - height / 2
    if below <= 0.1 or any(fixture.angles[:2]):
        return ""
    return "".join(
        f'<geom class="looks" type="box" size="0.025 0.025 {below / 2}" rgba="0.42 0.43 0.45 1" '
        f'pos="{side * (width / 2 - 0.06)} {end * (depth / 2 - 0.06)} {-(height + below) / 2}"/>'
        for side in (-1, 1)
        for end in (-1, 1)
    )


def _mark_xml(mark: Mark) -> str:
    x, y, z = mark.centre
    return (
        f'<geom name="{mark.name}" class="looks" type="box" size="{_halves(mark.size)} 0.0005" '
        f'pos="{_numbers((x, y, z + 0.0002))}" rgba="{_numbers(mark.rgba)}"/>'
    )


def stands(robot: RobotModel) -> bool:
    """Whether its base is above the floor, on a pedestal."""
    return robot.base.z > 0.0


def _robot_xml(prefix: str, robot: RobotModel) -> str:
    """The pedestal, and the body to which the robot is attached."""
    base = robot.base
    x, y, half = base.x, base.y, base.z / 2
    turned = _quaternion(base.theta_x, base.theta_y, base.theta_z)
    pedestal = (
        f'<geom name="{prefix}pedestal" class="fixture" type="cylinder" size="0.09 {half}" '
        f'pos="{_numbers((x, y, half))}" rgba="0.33 0.35 0.38 1"/>'
    )
    return (pedestal if stands(robot) else "") + (
        f'<body name="{prefix}{ROBOT_BODY}" pos="{_numbers((x, y, base.z))}" quat="{turned}"/>'
    )


def cell_xml(scene: Scene, robots: Mapping[str, RobotModel]) -> str:
    """MJCF of what stands in the cell, with an empty body for each robot."""
    fixtures = "".join(_fixture_xml(fixture) for fixture in scene.fixtures)
    marks = "".join(_mark_xml(mark) for mark in scene.marks)
    stands = "".join(_robot_xml(prefix, robot) for prefix, robot in robots.items())
    return f"""<mujoco model="cell">{HEAD}{_LOOKS}
<worldbody>
  <light pos="1.5 -1.5 4" dir="-0.3 0.35 -1" diffuse="0.55 0.55 0.55" castshadow="true"/>
  <geom name="floor" class="fixture" type="plane" size="4 4 0.1" material="floor"/>
  {fixtures}{stands}{marks}
</worldbody>
</mujoco>"""
