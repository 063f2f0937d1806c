"""With many parts, those at rest sleep: that costs nothing and changes nothing that can be seen."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mutabot_cell import Box, Cell, Scene
from mutabot_cell.display.contacts import Contacts
from mutabot_cell.models.sleeping import MANY

ENABLE, DISABLE = mujoco.mjtEnableBit, mujoco.mjtDisableBit


def layers(count: int) -> tuple[Box, ...]:
    """Boxes in layers of nine under the arm, 2 mm apart."""
    return tuple(
        Box(
            name=f"box {number}",
            jitter=0.0,
            position=(0.5 + number // 3 % 3 * 0.052, number % 3 * 0.052, 1.0 + number // 9 * 0.05),
        )
        for number in range(count)
    )


def stacked(count: int, seed: int = 1) -> Cell:
    return Cell(seed, scene=Scene(parts=layers(count)))


def disturb(cell: Cell) -> None:
    """Push over what stands in the way of the closed fingers."""
    cell.wait(0.5)
    cell.gripper.command(1, wait=True)
    cell.arm.move_joints((0.0, 26.0, 180.0, -78.0, 0.0, -76.0, 90.0))
    pose = cell.arm.commanded_pose()
    cell.arm.move_by(x=0.55 - pose.x, y=-0.12 - pose.y)
    cell.arm.move_by(z=0.135 - pose.z)
    cell.arm.move_by(y=0.10, speed=0.3)
    cell.wait(1.0)


def state(cell: Cell) -> bytes:
    return cell.simulation.data.qpos.tobytes() + cell.simulation.data.qvel.tobytes()


@pytest.mark.parametrize("count", [MANY - 1, MANY])
def test_parts_sleep_only_where_there_are_many(count: int) -> None:
    option = stacked(count).simulation.model.opt
    assert bool(option.enableflags & ENABLE.mjENBL_SLEEP) == (count >= MANY)
    assert bool(option.disableflags & DISABLE.mjDSBL_ISLAND) == (count < MANY)


def test_parts_at_rest_fall_asleep_and_those_that_are_touched_wake() -> None:
    cell = stacked(18)
    cell.wait(0.5)
    data = cell.simulation.data
    assert data.ntree_awake == 1, "the robot alone"
    before = data.qpos.copy()
    most = 0

    def note() -> None:
        nonlocal most
        most = max(most, int(data.ntree_awake))

    cell.simulation.after_tick.append(note)
    disturb(cell)
    assert most > 1
    moved = np.abs(data.qpos - before)[9:].max()
    assert moved > 0.01


def test_same_seed_gives_a_bit_identical_run_although_parts_sleep_and_wake() -> None:
    ends = []
    for _ in range(2):
        cell = stacked(18, seed=3)
        disturb(cell)
        ends.append((state(cell), cell.sensors.box_position("box 17"), cell.time))
    assert ends[0] == ends[1]


def test_a_copy_of_the_whole_state_goes_on_bit_identically_with_parts_asleep() -> None:
    """A forked process is one."""
    cell = stacked(9)
    cell.wait(0.5)
    model, data = cell.simulation.model, cell.simulation.data
    copy = mujoco.MjData(model)
    mujoco.mj_copyData(copy, model, data)
    for copied in (data, copy):
        copied.joint("box 4").qvel[0] = 0.3
        for _ in range(200):
            mujoco.mj_step(model, copied)
    assert copy.qpos.tobytes() == data.qpos.tobytes()


def test_sleep_moves_nothing_that_would_have_moved_awake() -> None:
    """A stack at rest is where it would be if it had been computed all the time."""
    ends = []
    for sleeps in (True, False):
        cell = stacked(9)
        if not sleeps:
            cell.simulation.model.opt.enableflags &= ~int(ENABLE.mjENBL_SLEEP)
        cell.wait(3.0)
        ends.append(cell.simulation.data.qpos.copy())
    assert np.abs(ends[0] - ends[1]).max() < 1e-4


def test_a_stack_stands_as_high_as_its_boxes() -> None:
    cell = stacked(27)
    cell.wait(1.0)
    tops = [cell.truth.box_position(f"box {number}").z for number in range(18, 27)]
    assert tops == pytest.approx([1.1] * 9, abs=5e-4)
    assert max(cell.truth.box_tilt(f"box {number}") for number in range(27)) < 0.1


def test_what_sleeps_still_touches_what_it_lies_on() -> None:
    cell = stacked(18)
    contacts = Contacts(cell.simulation)
    cell.wait(0.5)
    assert cell.simulation.data.ncon == 0
    pairs = {frozenset(pair) for pair in contacts.read()}
    expected = {frozenset((f"box {number}", "conveyor")) for number in range(9)}
    expected |= {frozenset((f"box {number}", f"box {number + 9}")) for number in range(9)}
    assert pairs == expected


def test_the_camera_sees_parts_that_sleep() -> None:
    cell = stacked(9)
    cell.wait(0.5)
    seen, exact = cell.sensors.box_position("box 8"), cell.truth.box_position("box 8")
    assert (seen.x, seen.y, seen.z) == pytest.approx((exact.x, exact.y, exact.z), abs=0.003)
