from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from mutabot_cell import BadArgument, Cell, MotionRefused, Pose, ProtectiveStop
from mutabot_cell.models import kinova
from mutabot_cell.simulation import TICK

SPEED = np.array([joint.speed for joint in kinova.JOINTS])
ACCELERATION = np.array([joint.acceleration for joint in kinova.JOINTS])

MOVES = [
    {"y": 0.2},
    {"theta_x": 80.0},
    {"z": -0.2},
    {"theta_z": 80.0},
    {"x": -0.2, "y": 0.3, "theta_z": 45.0},
]


def record(cell: Cell) -> tuple[list[np.ndarray], list[Pose]]:
    """Joint setpoints (rad) and true tool poses at every tick from now on."""
    setpoints: list[np.ndarray] = []
    poses: list[Pose] = []

    def note() -> None:
        setpoints.append(np.radians(cell.arm.commanded_joints()))
        poses.append(cell.truth.tool_pose())

    cell.simulation.after_tick.append(note)
    return setpoints, poses


@pytest.mark.parametrize("move", MOVES, ids=str)
def test_joint_speed_and_acceleration_limits_hold_over_a_line(cell: Cell, move: dict[str, float]) -> None:
    setpoints, _ = record(cell)
    cell.simulation.tick()
    cell.arm.move_by(**move)
    speeds = np.diff(setpoints, axis=0) / TICK
    accelerations = np.diff(speeds, axis=0) / TICK
    assert (np.abs(speeds) / SPEED).max() <= 1.0 + 1e-6
    assert (np.abs(accelerations) / ACCELERATION).max() <= 1.0 + 1e-3


def test_joint_limits_hold_over_a_joint_move(cell: Cell) -> None:
    setpoints, _ = record(cell)
    cell.simulation.tick()
    cell.arm.move_joints((60, -20, 150, -80, 90, 30, -10))
    speeds = np.diff(setpoints, axis=0) / TICK
    assert (np.abs(speeds) / SPEED).max() <= 1.0 + 1e-3
    assert (np.abs(np.diff(speeds, axis=0) / TICK) / ACCELERATION).max() <= 1.0 + 1e-2


def test_tool_speed_limit_holds(cell: Cell) -> None:
    _, poses = record(cell)
    cell.arm.move_by(z=-0.29)
    positions = np.array([pose.position for pose in poses])
    assert np.linalg.norm(np.diff(positions, axis=0), axis=1).max() / TICK <= kinova.TOOL_SPEED * 1.02


@pytest.mark.parametrize("move", [{"y": 0.2}, {"z": -0.2}, {"x": -0.2, "y": 0.3}], ids=str)
def test_tool_travels_in_a_straight_line_within_a_millimetre(cell: Cell, move: dict[str, float]) -> None:
    assert cell.truth.tool_position() == cell.truth.tool_pose().position
    start = np.array(cell.truth.tool_position())
    direction = np.array([move.get(axis, 0.0) for axis in "xyz"])
    direction /= np.linalg.norm(direction)
    _, poses = record(cell)
    cell.arm.move_by(**move)
    away = np.array([pose.position for pose in poses]) - start
    sideways = away - np.outer(away @ direction, direction)
    assert np.linalg.norm(sideways, axis=1).max() < 0.001


def test_relative_moves_start_at_the_commanded_pose(cell: Cell) -> None:
    before = cell.arm.commanded_pose()
    for _ in range(5):
        cell.arm.move_by(y=0.02)
    after = cell.arm.commanded_pose()
    assert after.y - before.y == pytest.approx(0.1, abs=5e-4)
    assert (after.x, after.z) == pytest.approx((before.x, before.z), abs=5e-4)


def test_move_to_and_move_by_agree(cell: Cell) -> None:
    other = Cell(seed=1)
    pose = cell.arm.commanded_pose()
    cell.arm.move_by(y=0.1, theta_x=20)
    other.arm.move_to(Pose(pose.x, pose.y + 0.1, pose.z, pose.theta_x + 20, pose.theta_y, pose.theta_z))
    assert cell.truth.world() == other.truth.world()


def test_arm_reaches_its_target(cell: Cell) -> None:
    cell.arm.move_to(Pose(0.4, 0.2, 0.4, 150, 0, 90))
    cell.wait(0.3)
    pose = cell.truth.tool_pose()
    assert (pose.x, pose.y, pose.z) == pytest.approx((0.4, 0.2, 0.4), abs=0.001)
    assert (pose.theta_x, pose.theta_y, pose.theta_z) == pytest.approx((150, 0, 90), abs=0.2)


def test_slower_speed_takes_longer(cell: Cell) -> None:
    cell.arm.move_by(y=0.2)
    fast = cell.time
    cell.arm.move_by(y=-0.2, speed=0.2)
    assert cell.time - fast > 1.5 * fast


def test_continuous_joints_turn_the_shorter_way_home(cell: Cell) -> None:
    away = list(kinova.HOME_DEGREES)
    away[6] = -170.0
    cell.arm.move_joints(away)
    assert abs(cell.arm.commanded_joints()[6] - 90.0) < 180.0


@pytest.mark.parametrize(
    ("move", "limit"),
    [
        ({"x": 0.9}, "reach"),
        ({"z": 0.6}, "reach"),
        ({"x": -0.9}, "joint 4"),  # right through the robot's own column
    ],
    ids=str,
)
def test_line_out_of_limits_is_refused_before_anything_moves(
    cell: Cell, move: dict[str, float], limit: str
) -> None:
    before, commanded, clock = cell.truth.world(), cell.arm.commanded_joints(), cell.time
    with pytest.raises(MotionRefused) as refusal:
        cell.arm.move_by(**move)
    assert refusal.value.limit == limit
    assert refusal.value.excess > 0
    assert 0 < refusal.value.fraction < 1
    assert f"{refusal.value.fraction:.0%}" in str(refusal.value)
    assert (cell.truth.world(), cell.arm.commanded_joints(), cell.time) == (before, commanded, clock)


def test_refusal_for_reach_says_by_how_much(cell: Cell) -> None:
    with pytest.raises(MotionRefused, match=r"mm more than the arm's 0\.735 m") as refusal:
        cell.arm.move_by(x=0.9)
    error = refusal.value
    assert error.unit == "m"
    assert error.value is not None
    assert error.allowed is not None
    assert error.excess == pytest.approx(error.value - error.allowed)


def test_joint_target_beyond_a_limit_is_refused_with_joint_and_amount(cell: Cell) -> None:
    with pytest.raises(MotionRefused, match=r"joint 4 .* 12\.2 deg beyond") as refusal:
        cell.arm.move_joints((0, 15, 180, -160, 0, 55, 90))
    assert refusal.value.limit == "joint 4"
    assert refusal.value.excess == pytest.approx(160 - 147.8)
    assert refusal.value.allowed == pytest.approx(-147.8)
    assert cell.time == 0.0


def test_line_back_to_where_it_is_takes_no_time(cell: Cell) -> None:
    cell.arm.move_by()
    assert cell.time == 0.0


def test_pushing_into_the_conveyor_stops_the_arm_and_names_it(cell: Cell) -> None:
    cell.arm.move_by(y=-0.2)
    cell.arm.move_by(theta_x=80)
    with pytest.raises(ProtectiveStop, match="touched conveyor") as stop:
        cell.arm.move_by(z=-0.4)
    error = stop.value
    assert error.second == "conveyor"
    assert error.force > 20
    assert 1 <= error.joint <= 7
    assert error.time == pytest.approx(cell.time)
    resting = cell.truth.tool_pose().z
    cell.wait(1.0)
    assert cell.truth.tool_pose().z == pytest.approx(resting, abs=0.02)


def test_after_a_protective_stop_motions_are_refused_until_it_is_acknowledged(cell: Cell) -> None:
    cell.arm.move_by(theta_x=90)
    with pytest.raises(ProtectiveStop):
        cell.arm.move_by(z=-0.45)
    with pytest.raises(MotionRefused) as refusal:
        cell.arm.home()
    assert refusal.value.limit == "protective stop"
    cell.arm.acknowledge_stop()
    cell.arm.home()
    assert cell.truth.tool_pose().z == pytest.approx(0.4337, abs=0.002)


def test_box_laid_down_softly_does_not_stop_the_arm(cell: Cell, grip: Callable[[Cell], None]) -> None:
    grip(cell)
    cell.arm.move_by(z=0.1)
    cell.arm.move_by(z=-0.1)
    assert cell.gripper.holding()
    cell.gripper.command(0)
    cell.wait(0.5)
    assert cell.truth.box_position().z == pytest.approx(1.0, abs=0.002)


def test_fingers_driven_onto_the_box_stop_the_arm(cell: Cell) -> None:
    cell.arm.move_by(y=0.2)
    cell.arm.move_by(theta_x=80)
    cell.gripper.command(1, wait=True)
    cell.arm.move_by(x=-0.027)
    with pytest.raises(ProtectiveStop) as stop:
        cell.arm.move_by(z=-0.29)
    assert "box" in (stop.value.first, stop.value.second)


@pytest.mark.parametrize("value", [math.nan, math.inf, "0.1", None, True])
def test_amounts_that_are_no_numbers_are_refused_at_the_border(cell: Cell, value: object) -> None:
    with pytest.raises(BadArgument, match="finite numbers"):
        cell.arm.move_by(x=value)  # type: ignore[arg-type]
    with pytest.raises(BadArgument):
        cell.arm.move_joints((value,) * 7)  # type: ignore[arg-type]


@pytest.mark.parametrize("speed", [0.0, -1.0, 1.5, math.nan])
def test_speed_outside_its_range_is_refused(cell: Cell, speed: float) -> None:
    with pytest.raises(BadArgument, match="speed"):
        cell.arm.move_by(x=-0.1, speed=speed)
