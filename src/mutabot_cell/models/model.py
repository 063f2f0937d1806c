"""The contents of the cell as MJCF text."""

from __future__ import annotations

from collections.abc import Mapping

from mutabot_cell.geometry import quaternion_from_euler
from mutabot_cell.scene import Fixture, Mark, Scene

from .options import HEAD
from .robot import RobotModel

ROBOT_BODY = "robot"
"""Behind a robot's prefix, the name of the body that stands at its base."""


def _numbers(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def _halves(values: tuple[float, ...]) -> str:
    return _numbers(tuple(value / 2 for value in values))


def _quaternion(theta_x: float, theta_y: float, theta_z: float) -> str:
    return _numbers(tuple(quaternion_from_euler(theta_x, theta_y, theta_z).tolist()))


def _fixture_xml(fixture: Fixture) -> str:
    """Return the MJCF of a fixture as a movable body; fixtures come before robots."""
    return (
        f'<body name="{fixture.name}" pos="{_numbers(fixture.centre)}" quat="{_quaternion(*fixture.angles)}">'
        f'<geom name="{fixture.name}" class="fixture" type="box" size="{_halves(fixture.size)}" '
        f'rgba="{_numbers(fixture.rgba)}"/></body>'
    )


def _mark_xml(mark: Mark) -> str:
    x, y, z = mark.centre
    return (
        f'<geom name="{mark.name}" class="looks" type="box" size="{_halves(mark.size)} 0.0005" '
        f'pos="{_numbers((x, y, z + 0.0002))}" rgba="{_numbers(mark.rgba)}"/>'
    )


def is_on_pedestal(robot: RobotModel) -> bool:
    """Return whether a robot's base is above the floor, on a pedestal."""
    return robot.base.z > 0.0


def _robot_xml(prefix: str, robot: RobotModel) -> str:
    """Return the MJCF of the pedestal, and of the body to which the robot is attached."""
    base = robot.base
    x, y, half = base.x, base.y, base.z / 2
    turned = _quaternion(base.theta_x, base.theta_y, base.theta_z)
    pedestal = (
        f'<geom name="{prefix}pedestal" class="fixture" type="cylinder" size="0.09 {half}" '
        f'pos="{_numbers((x, y, half))}" rgba="0.33 0.35 0.38 1"/>'
    )
    return (pedestal if is_on_pedestal(robot) else "") + (
        f'<body name="{prefix}{ROBOT_BODY}" pos="{_numbers((x, y, base.z))}" quat="{turned}"/>'
    )


def cell_xml(scene: Scene, robots: Mapping[str, RobotModel]) -> str:
    """Return the MJCF of the cell's contents, with an empty body for each robot."""
    fixtures = "".join(_fixture_xml(fixture) for fixture in scene.fixtures)
    marks = "".join(_mark_xml(mark) for mark in scene.marks)
    robot_texts = "".join(_robot_xml(prefix, robot) for prefix, robot in robots.items())
    return f"""<mujoco model="cell">{HEAD}
<worldbody>
  <geom name="floor" class="fixture" type="plane" size="4 4 0.1"/>
  {fixtures}{robot_texts}{marks}
</worldbody>
</mujoco>"""
