"""Builds MuJoCo models: the cell with the robots attached to it, and an arm alone for the planner."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np

from mutabot_cell.geometry import Array
from mutabot_cell.scene import FRICTION_ON_STEEL, Scene

from .effectors import Fingers
from .model import ROBOT_BODY, cell_xml, is_on_pedestal
from .options import compile_quietly
from .parts import add_grip, add_part, add_surfaces
from .robot import RobotModel
from .sleeping import MANY, let_sleep
from .stripping import ARM_CLASS, GRIPPER_CLASS
from .tool import Tool

TOOL_SITE, PAYLOAD_BODY = "tool", "payload"
"""Behind a robot's prefix, names of what the cell adds to it: the tool point, and the empty body at which the
controller compensates the declared payload's weight."""

_CLASSES_OF_A_ROBOT, _ALL_CLASSES = 2, 2**31 - 1
"""A robot needs two bits of the collision classes, one for the arm and one for the gripper; there are 31."""
FINGER_SENSORS = ("finger path", "finger speed", "finger force")
"""Behind a robot's prefix, what its gripper measures of the servo of its fingers."""

_MEASURED = (
    mujoco.mjtSensor.mjSENS_ACTUATORPOS,
    mujoco.mjtSensor.mjSENS_ACTUATORVEL,
    mujoco.mjtSensor.mjSENS_ACTUATORFRC,
)
_PAYLOAD_MARKER = 1e-6
"""Mass of the empty body at which the controller compensates a payload, kg."""


def build_cell(scene: Scene, robots: Mapping[str, RobotModel]) -> mujoco.MjModel:
    """Compile the whole cell. `robots` by the prefix of their names in it, which may be empty."""
    return compile_quietly(cell_spec(scene, robots))


def cell_spec(scene: Scene, robots: Mapping[str, RobotModel]) -> mujoco.MjSpec:
    """Return the spec of the whole cell, to be compiled; see `build_cell`."""
    spec = mujoco.MjSpec.from_string(cell_xml(scene, robots))
    for index, (prefix, robot) in enumerate(robots.items()):
        part = _equipped(robot, robot.tool)
        if index:
            _collide_with_others(part, index)
        spec.attach(part, frame=spec.body(prefix + ROBOT_BODY).add_frame(), prefix=prefix)
    for loose in scene.parts:
        add_part(spec, loose)
        for prefix, robot in robots.items():
            if robot.tool is not None and robot.tool.effector is not None:
                add_grip(spec, loose, prefix, robot.tool.effector)
        add_surfaces(spec, loose, _surfaces(scene, robots))
    if len(scene.parts) >= MANY:
        let_sleep(spec)
    return spec


def _collide_with_others(part: mujoco.MjSpec, index: int) -> None:
    """Give a further robot's arm and gripper their own collision classes, so that robots touch each other."""
    for geom in part.geoms:
        if geom.contype in (ARM_CLASS, GRIPPER_CLASS):
            own = geom.contype << (_CLASSES_OF_A_ROBOT * index + 1)
            geom.contype, geom.conaffinity = own, _ALL_CLASSES & ~own


def build_arm(robot: RobotModel) -> mujoco.MjModel:
    """Compile the arm with its tool point, for kinematics and planning; its base frame is the world frame."""
    return compile_quietly(_equipped(robot, None))


def build_robot(robot: RobotModel) -> mujoco.MjModel:
    """Compile the robot alone with its tool; its base frame is the world frame."""
    return compile_quietly(_equipped(robot, robot.tool))


def _surfaces(scene: Scene, robots: Mapping[str, RobotModel]) -> list[tuple[str, float]]:
    """Return the names of the surfaces that parts may lie on, with their friction against a dry part."""
    found = [(fixture.name, fixture.friction) for fixture in scene.fixtures]
    found.append(("floor", FRICTION_ON_STEEL))
    found += [(f"{prefix}pedestal", FRICTION_ON_STEEL) for prefix in robots if is_on_pedestal(robots[prefix])]
    return found


def compensation_of(payload: float) -> float:
    """Return the `gravcomp` of a robot's body "payload" that carries `payload` kg."""
    return payload / _PAYLOAD_MARKER


def _equipped(robot: RobotModel, tool: Tool | None) -> mujoco.MjSpec:
    """Return the arm with this tool, its tool point, and what the controller needs for a payload."""
    spec = robot.spec.copy()
    flange = spec.site(robot.flange)
    if tool is not None:
        allow_mount_overlap(spec, flange.parent, tool)
        frame = flange.parent.add_frame(pos=flange.pos, quat=flange.quat)
        spec.attach(tool.spec.copy(), frame=frame, prefix="")
        if isinstance(tool.effector, Fingers):
            _measure(spec, tool.effector.actuator)
    point, turn = _tool_point(flange, robot.tool)
    flange.parent.add_site(name=TOOL_SITE, pos=point, quat=turn, size=(0.002,) * 3, rgba=(0, 0, 0, 0))
    payload = flange.parent.add_body(name=PAYLOAD_BODY, pos=point, quat=turn, gravcomp=1.0)
    payload.mass, payload.inertia, payload.ipos = _PAYLOAD_MARKER, (1e-9,) * 3, (0.0, 0.0, 0.0)
    payload.explicitinertial = True
    return spec


def _measure(spec: mujoco.MjSpec, servo: str) -> None:
    """Add the sensors by which a gripper measures its fingers' servo."""
    for name, sensor in zip(FINGER_SENSORS, _MEASURED, strict=True):
        spec.add_sensor(name=name, type=sensor, objtype=mujoco.mjtObj.mjOBJ_ACTUATOR, objname=servo)


def allow_mount_overlap(spec: mujoco.MjSpec, link: mujoco.MjsBody, tool: Tool) -> None:
    """Let a tool's mount overlap the last two links, as flanges do."""
    for body in (link, link.parent):
        for part in tool.spec.bodies:
            if part.name and part.name != "world" and body.name and body != spec.worldbody:
                spec.add_exclude(bodyname1=body.name, bodyname2=part.name)


def _tool_point(flange: mujoco.MjsSite, tool: Tool | None) -> tuple[Array, Array]:
    """Return position, shape (3,), m, and quaternion, shape (4,), of the tool point in the flange's body."""
    point, turn = flange.pos.copy(), flange.quat.copy()
    mujoco.mju_normalize4(turn)
    if tool is not None:
        away, whole = np.zeros(3), np.zeros(4)
        mujoco.mju_rotVecQuat(away, np.array(tool.point), turn)
        point += away
        mujoco.mju_mulQuat(whole, turn, np.array(tool.turn))
        turn = whole
    return point, turn
