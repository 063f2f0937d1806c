"""Conveyor tracking: what physics and the encoder allow, and what the arm's limits forbid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mutabot_cell import Belt, Box, Cell, MotionRefused, PathLost, Pose, ProtectiveStop, Scene
from mutabot_cell.models.kinova import gen3
from mutabot_cell.models.options import PHYSICS_STEP
from mutabot_cell.motion.tracking import FILTER_TIME
from mutabot_cell.scene import CONVEYOR, TARGET_TABLE
from mutabot_cell.simulation import TICK

OVER_BELT = (20, 26, 180, -78, 0, -76, 90)
"""Joint angles, degrees: the gripper looks down, over the conveyor, upstream."""


def over_belt(speed: float, belt: Belt | None = None, *boxes: Box) -> Cell:
    """The arm waits over the belt, which runs evenly."""
    conveyor = replace(CONVEYOR, belt=belt or Belt())
    cell = Cell(1, scene=Scene(fixtures=(conveyor, TARGET_TABLE), parts=boxes))
    cell.arm.move_joints(OVER_BELT)
    cell.belt().run(speed)
    cell.wait(2.0)
    return cell


def behind_belt(cell: Cell, seconds: float) -> np.ndarray:
    """How far the tool falls behind a point of the belt, relative to its own start, m, per tick."""
    errors = []
    tool, belt = cell.truth.tool_position().y, cell.truth.belt_position()

    def note() -> None:
        errors.append(cell.truth.belt_position() - belt - (cell.truth.tool_position().y - tool))

    cell.simulation.after_tick.append(note)
    cell.wait(seconds)
    cell.simulation.after_tick.remove(note)
    return np.array(errors)


@pytest.mark.parametrize("speed", [0.05, 0.1, -0.1, 0.2])
def test_at_an_even_speed_the_tool_keeps_its_place_on_the_belt_as_exactly_as_the_encoder_counts(
    speed: float,
) -> None:
    cell = over_belt(speed)
    if speed < 0:
        cell.arm.move_by(y=0.25)
    cell.arm.track(cell.belt())
    cell.wait(0.2)
    assert np.abs(behind_belt(cell, 0.6)).max() < Belt().resolution


def test_the_tool_is_over_what_it_was_sent_to_while_that_moves_on() -> None:
    box = Box(position=(0.55, -0.55, 1.0), jitter=0.0)
    cell = over_belt(0.1, None, box)
    since, seen = cell.belt().position(), cell.truth.box_position()
    cell.wait(0.5)
    cell.arm.track(cell.belt(), since)
    cell.arm.move_to(Pose(seen.x, seen.y, 0.25, 180, 0, 90))
    now, tool = cell.truth.box_position(), cell.truth.tool_position()
    assert now.y - seen.y > 0.1
    follows_within = 0.1 * PHYSICS_STEP + Belt().resolution
    assert tool.y == pytest.approx(now.y, abs=0.0005 + follows_within), "a line is followed to 0.5 mm"
    assert tool.x == pytest.approx(now.x, abs=0.0005)


def test_a_box_is_picked_from_the_moving_belt() -> None:
    box = Box(position=(0.55, -0.55, 1.0), jitter=0.0)
    cell = over_belt(0.08, None, box)
    since, seen = cell.belt().position(), cell.truth.box_position()
    cell.arm.track(cell.belt(), since)
    cell.arm.move_to(Pose(seen.x, seen.y, 0.25, 180, 0, 90))
    cell.arm.move_by(z=-0.12)
    cell.gripper.command(1)
    cell.wait(0.8)
    assert cell.gripper.holding()
    cell.arm.move_by(z=0.12)
    cell.arm.stop_tracking()
    assert cell.truth.box_position().z > 1.1
    resting = cell.truth.tool_position()
    cell.wait(0.5)
    assert cell.truth.tool_position().y == pytest.approx(resting.y, abs=1e-4)


def test_while_the_belt_accelerates_the_tool_is_behind_by_what_the_filter_says() -> None:
    """While the change of speed is news to the filter, it makes a·tau² or two; then that is followed too."""
    acceleration = 0.2
    cell = over_belt(0.05, Belt(acceleration=acceleration))
    cell.arm.track(cell.belt())
    cell.wait(0.2)
    cell.belt().run(0.17)
    errors = behind_belt(cell, 0.5)
    assert 0.2 * acceleration * FILTER_TIME**2 < errors.max() < 2 * acceleration * FILTER_TIME**2
    assert np.abs(errors[40:]).max() < 2 * Belt().resolution, "it still accelerates, and is followed"
    assert cell.truth.belt_speed() < 0.17
    cell.belt().stop()
    cell.wait(1.5)
    assert np.abs(behind_belt(cell, 0.3)).max() < 1e-4, "on a belt that stands the tool stands"


def test_following_and_what_is_added_to_it_keep_the_limits_of_joints_and_tool() -> None:
    cell = over_belt(0.2)
    robot = gen3()
    setpoints, poses = [], []

    def note() -> None:
        setpoints.append(np.radians(cell.arm.commanded_joints()))
        poses.append(np.array(cell.truth.tool_position()))

    cell.simulation.after_tick.append(note)
    cell.arm.track(cell.belt())
    cell.arm.move_by(z=-0.1, x=0.05)
    cell.arm.stop_tracking()
    speeds = np.diff(setpoints, axis=0) / TICK
    assert (np.abs(speeds) <= robot.limits.speed).all()
    assert (np.abs(np.diff(speeds, axis=0)) / TICK <= np.array(robot.limits.acceleration) * 1.01).all()
    velocities = np.diff(poses, axis=0) / TICK
    assert np.linalg.norm(velocities, axis=1).max() <= robot.tool_limits.speed * 1.02
    assert np.linalg.norm(np.diff(velocities, axis=0), axis=1).max() / TICK <= (
        robot.tool_limits.acceleration * 1.2
    ), "the servos follow the setpoints within some parts of a hundred"


def test_moves_in_the_belts_frame_are_straight_in_it() -> None:
    cell = over_belt(0.1)
    cell.arm.track(cell.belt())
    cell.wait(0.2)
    tool, belt = np.array(cell.truth.tool_position()), cell.truth.belt_position()
    places = []

    def note() -> None:
        moved = np.array((0.0, cell.truth.belt_position() - belt, 0.0))
        places.append(np.array(cell.truth.tool_position()) - tool - moved)

    cell.simulation.after_tick.append(note)
    cell.arm.move_by(x=0.06, z=-0.08)
    direction = np.array((0.06, 0.0, -0.08)) / 0.1
    away = np.array(places)
    assert np.linalg.norm(away - np.outer(away @ direction, direction), axis=1).max() < 0.001
    assert away[-1] @ direction == pytest.approx(0.1, abs=0.001)


def test_a_move_on_the_belt_can_be_stopped_there() -> None:
    cell = over_belt(0.1)
    cell.arm.track(cell.belt())
    start = cell.arm.commanded_pose()
    move = cell.arm.start_move_by(x=0.1)
    cell.wait(0.2)
    assert not move.done
    move.stop()
    assert move.done
    assert cell.arm.is_tracking()
    assert 0.01 < cell.arm.commanded_pose().x - start.x < 0.09
    cell.wait(0.2)
    assert np.abs(behind_belt(cell, 0.3)).max() < Belt().resolution


def test_a_thing_that_leaves_the_arms_reach_is_let_go_and_the_arm_brakes() -> None:
    cell = over_belt(0.3)
    cell.arm.track(cell.belt())
    with pytest.raises(PathLost, match=r"cannot follow: joint \d would .* beyond its limit of") as lost:
        cell.wait(5.0)
    assert lost.value.excess > 0
    assert lost.value.value is not None
    assert lost.value.limit.startswith("joint")
    assert not cell.arm.is_tracking()
    assert np.abs(cell.simulation.data.qvel[cell.simulation.robot.dofs]).max() < 0.02
    cell.arm.home()


def test_a_move_that_is_lost_on_the_belt_says_so_where_it_was_asked_for() -> None:
    cell = over_belt(0.1)
    cell.arm.track(cell.belt())
    move = cell.arm.start_move_by(z=-0.02, speed=0.02)
    cell.belt().run(0.5)
    with pytest.raises(PathLost):
        move.wait()
    assert move.done
    cell.arm.home()


def test_a_place_that_is_out_of_reach_when_the_tool_gets_there_is_refused_and_following_goes_on() -> None:
    cell = over_belt(0.1)
    cell.arm.track(cell.belt())
    before = cell.arm.commanded_pose()
    with pytest.raises(MotionRefused, match="reach") as refusal:
        cell.arm.move_by(x=0.4)
    assert refusal.value.excess > 0
    assert cell.arm.is_tracking()
    assert cell.arm.commanded_pose() == before


def test_a_belt_that_is_faster_than_the_tool_may_be_is_refused_by_how_much() -> None:
    cell = over_belt(0.7, Belt(speed_limit=1.0, acceleration=1.0))
    with pytest.raises(MotionRefused, match=r"0\.150 m/s more than the tool's limit of 0\.55 m/s") as refusal:
        cell.arm.track(cell.belt())
    assert refusal.value.limit == "tool speed"
    assert refusal.value.excess == pytest.approx(0.15, abs=0.002)


def test_joint_moves_are_refused_while_the_arm_tracks() -> None:
    cell = over_belt(0.05)
    cell.arm.track(cell.belt())
    for move in (cell.arm.home, lambda: cell.arm.move_joints(OVER_BELT), lambda: cell.arm.track(cell.belt())):
        with pytest.raises(MotionRefused) as refusal:
            move()
        assert refusal.value.limit == "tracking"
    cell.arm.stop_tracking()
    cell.arm.home()


def test_what_stands_in_the_way_stops_an_arm_that_tracks() -> None:
    cell = over_belt(0.1)
    cell.arm.track(cell.belt())
    with pytest.raises(ProtectiveStop, match="touched conveyor"):
        cell.arm.move_by(z=-0.25)
    assert not cell.arm.is_tracking()
    with pytest.raises(MotionRefused, match="not acknowledged"):
        cell.arm.track(cell.belt())


def test_a_wandering_belt_is_followed_to_what_it_wanders_in_the_filters_time() -> None:
    """Speed errors that last shorter than the filter's time constant pass unseen: sigma·v·tau."""
    speed, jitter = 0.1, 0.05
    cell = over_belt(speed, Belt(jitter=jitter, jitter_time=0.5))
    cell.arm.track(cell.belt())
    cell.wait(0.3)
    errors = behind_belt(cell, 1.5)
    assert errors.std() < 2 * jitter * speed * FILTER_TIME
