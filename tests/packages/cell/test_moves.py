"""Motions that do not block do the same as those that do; stopped ones end on their path."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mutabot_cell import Cell, MotionRefused, Pose, ProtectiveStop
from mutabot_cell.models.kinova import gen3
from mutabot_cell.simulation import TICK

ELSEWHERE = (60, -20, 150, -80, 90, 30, -10)


def test_a_motion_that_was_waited_for_is_the_one_that_blocks() -> None:
    cell, other = Cell(1), Cell(1)
    cell.arm.move_by(y=0.2)
    cell.arm.move_joints(ELSEWHERE)
    cell.arm.home()
    other.arm.start_move_by(y=0.2).wait()
    other.arm.start_move_joints(ELSEWHERE).wait()
    other.arm.start_home().wait()
    assert cell.truth.world() == other.truth.world()


def test_a_motion_that_was_started_goes_on_while_time_passes_and_is_then_done() -> None:
    cell = Cell(1)
    before = cell.truth.tool_position()
    move = cell.arm.start_move_by(y=0.2)
    assert (cell.time, move.done) == (0.0, False)
    cell.wait(0.3)
    halfway = cell.truth.tool_position()
    assert 0.01 < halfway.y - before.y < 0.19
    assert not move.done
    cell.wait(2.0)
    assert move.done
    move.wait()
    assert cell.truth.tool_position().y - before.y == pytest.approx(0.2, abs=0.001)


def test_the_gripper_can_close_while_the_arm_moves() -> None:
    cell = Cell(1)
    move = cell.arm.start_move_by(y=0.2)
    cell.gripper.command(1)
    cell.wait(0.5)
    assert not move.done
    assert cell.gripper.opening() < 0.05


@pytest.mark.parametrize("after", [0.01, 0.1, 0.3, 0.5, 0.8])
def test_a_line_that_is_stopped_ends_at_rest_on_the_line(after: float) -> None:
    cell = Cell(1)
    start, limits = np.array(cell.truth.tool_position()), gen3().limits
    direction = np.array([-0.2, 0.3, 0.0]) / math.hypot(0.2, 0.3)
    move = cell.arm.start_move_by(x=-0.2, y=0.3)
    cell.wait(after)
    setpoints, places = [], []

    def note() -> None:
        setpoints.append(np.radians(cell.arm.commanded_joints()))
        places.append(np.array(cell.truth.tool_position()) - start)

    cell.simulation.after_tick.append(note)
    move.stop()
    assert move.done
    for _ in range(20):
        cell.simulation.tick()
    away = np.array(places)
    assert np.linalg.norm(away - np.outer(away @ direction, direction), axis=1).max() < 0.001
    assert away[-1] @ direction < math.hypot(0.2, 0.3) - 0.01, "it did not get there"
    speeds = np.diff(setpoints, axis=0) / TICK
    assert (np.abs(np.diff(speeds, axis=0) / TICK) <= np.array(limits.acceleration) * 1.01).all()
    assert np.abs(speeds[-1]).max() == 0.0
    assert np.abs(cell.simulation.data.qvel[cell.simulation.robot.dofs]).max() < 1e-3


def test_a_joint_move_that_is_stopped_rests_where_it_would_have_passed() -> None:
    whole = Cell(1)
    passed: list[tuple[float, ...]] = []
    whole.simulation.after_tick.append(lambda: passed.append(whole.arm.commanded_joints()))
    whole.arm.move_joints(ELSEWHERE)
    cell = Cell(1)
    move = cell.arm.start_move_joints(ELSEWHERE)
    cell.wait(0.5)
    move.stop()
    rest = cell.arm.commanded_joints()
    index = int(np.argmin(np.abs(np.array(passed) - rest).max(axis=1)))
    assert 50 < index < len(passed) - 50
    between = np.diff(passed, axis=0)[index - 1 : index + 1]
    assert np.abs(np.array(passed[index]) - rest).max() < np.abs(between).max(), "between two ticks of it"


def test_a_motion_that_is_nearly_there_arrives_when_it_is_stopped() -> None:
    cell = Cell(1)
    goal = cell.arm.commanded_pose()
    move = cell.arm.start_move_by(y=0.1)
    while abs(cell.arm.commanded_pose().y - goal.y - 0.1) > 1e-4:
        cell.simulation.tick()
    move.stop()
    assert cell.arm.commanded_pose().y == pytest.approx(goal.y + 0.1, abs=1e-4)


def test_stopping_what_has_ended_takes_no_time_and_moves_nothing() -> None:
    cell = Cell(1)
    move = cell.arm.start_move_by(y=0.05)
    move.wait()
    before, world = cell.time, cell.truth.world()
    move.stop()
    move.wait()
    assert (cell.time, cell.truth.world()) == (before, world)


def test_a_second_motion_is_refused_while_one_is_under_way() -> None:
    cell = Cell(1)
    move = cell.arm.start_move_by(y=0.2)
    cell.wait(0.1)
    line = Pose(0.4, 0.0, 0.4, 90.0, 0.0, 90.0)
    for another in (cell.arm.home, cell.arm.start_home, lambda: cell.arm.move_to(line)):
        with pytest.raises(MotionRefused) as refusal:
            another()
        assert refusal.value.limit == "motion under way"
    move.stop()
    cell.arm.home()


def test_a_line_out_of_reach_is_refused_before_anything_moves_also_if_it_would_not_block() -> None:
    cell = Cell(1)
    with pytest.raises(MotionRefused, match="out of reach"):
        cell.arm.start_move_by(x=0.9)
    cell.wait(0.2)
    assert cell.arm.commanded_pose().x == pytest.approx(0.5767, abs=1e-4)


def test_a_protective_stop_ends_a_motion_that_does_not_block_and_is_raised_by_what_lets_time_pass() -> None:
    cell = Cell(1)
    cell.arm.move_by(y=-0.2)
    cell.arm.move_by(theta_x=80)
    move = cell.arm.start_move_by(z=-0.4)
    with pytest.raises(ProtectiveStop, match="touched conveyor"):
        cell.wait(3.0)
    assert move.done
