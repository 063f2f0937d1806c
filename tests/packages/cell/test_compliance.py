"""Motions that the wrist's force sensor decides; true forces are read from the contacts."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from mutabot_cell import BadArgument, Box, Cell, Fixture, MotionRefused, PathLost, ProtectiveStop, Scene
from mutabot_cell.motion.compliance import ACCELERATION, GAIN
from mutabot_cell.scene import CONVEYOR, TARGET_TABLE
from mutabot_cell.simulation import TICK

DOWN = (0, 26, 180, -78, 0, -76, 90)
FINGERTIPS = 0.021
"""The fingers of a gripper that looks down reach this far below the tool point, m."""


def over_conveyor(*parts: Box, fixtures: tuple[Fixture, ...] = (CONVEYOR, TARGET_TABLE)) -> Cell:
    """The gripper looks down, its tips 28 mm above the conveyor; the force sensor is zeroed."""
    cell = Cell(1, scene=Scene(parts=parts, fixtures=fixtures))
    cell.arm.move_joints(DOWN)
    cell.arm.move_by(z=-0.15)
    cell.wait(0.3)
    cell.force_sensor.zero()
    return cell


def pressed_on(cell: Cell, name: str) -> float:
    """Normal forces of all contacts of a fixture, N."""
    model, data, wrench, total = cell.simulation.model, cell.simulation.data, np.zeros(6), 0.0
    for index in range(data.ncon):
        if name in {model.geom(geom).name for geom in data.contact.geom[index].tolist()}:
            mujoco.mj_contactForce(model, data, index, wrench)
            total += float(wrench[0])
    return total


def watched(cell: Cell, name: str) -> list[tuple[float, float]]:
    """From now on, at every tick: the true force on a fixture, N, and the commanded height of the tool, m."""
    seen: list[tuple[float, float]] = []
    cell.simulation.after_tick.append(
        lambda: seen.append((pressed_on(cell, name), cell.arm.commanded_pose().z))
    )
    return seen


@pytest.mark.parametrize("speed", [0.005, 0.02, 0.05])
def test_the_tool_stops_after_contact_within_what_reaction_and_braking_take(speed: float) -> None:
    """Two ticks until the sensor has read it and the setpoint heeds it, then v² / 2a."""
    cell = over_conveyor()
    seen = watched(cell, "conveyor")
    assert cell.arm.move_until_contact(z=-0.06, force=5.0, speed=speed)
    forces, heights = np.array(seen).T
    touch = int(np.argmax(forces > 0))
    stiffness = 10e3  # of servos and contact at least, N/m
    most = speed * 2 * TICK + speed**2 / (2 * ACCELERATION) + 5.0 / stiffness
    assert heights[touch - 1] - heights[-1] < most + speed * TICK
    assert cell.truth.tool_position().z - FINGERTIPS == pytest.approx(0.1, abs=0.0015)
    resting = cell.truth.tool_position()
    cell.wait(0.3)
    now = cell.truth.tool_position()
    assert math.dist((now.x, now.y, now.z), (resting.x, resting.y, resting.z)) < 2e-4


def test_without_contact_the_whole_way_is_gone_and_the_answer_is_no() -> None:
    cell = over_conveyor()
    before = cell.arm.commanded_pose()
    start = cell.time
    assert cell.arm.move_until_contact(x=-0.03, z=-0.01, force=3.0, speed=0.02) is False
    after = cell.arm.commanded_pose()
    assert (after.x - before.x, after.y - before.y, after.z - before.z) == pytest.approx(
        (-0.03, 0.0, -0.01), abs=2e-5
    )
    assert cell.time - start == pytest.approx(math.hypot(0.03, 0.01) / 0.02, abs=0.2)


def test_force_across_the_way_is_not_contact() -> None:
    """Something pulls sideways at the gripper: it rubs, but does not resist."""
    cell = over_conveyor()
    cell.simulation.data.xfrc_applied[cell.simulation.model.body("gripper").id, 1] = 10.0
    assert cell.arm.move_until_contact(z=-0.01, force=5.0) is False
    assert cell.arm.move_until_contact(y=-0.01, force=5.0) is True


def test_an_unzeroed_sensor_takes_the_tools_weight_for_a_resistance() -> None:
    cell = over_conveyor()
    cell.arm.move_by(z=0.05)
    other = Cell(1, scene=Scene(parts=()))
    other.arm.move_joints(DOWN)
    assert other.arm.move_until_contact(z=0.02, force=5.0) is True, "0.9 kg hang on it"
    assert cell.arm.move_until_contact(z=0.02, force=5.0) is False


@pytest.mark.parametrize("force", [5.0, 15.0, 40.0])
def test_what_is_pushed_feels_the_force_within_a_tenth_and_without_chatter(force: float) -> None:
    """The sensor's noise is 0.1 N a reading, and its zero is one reading."""
    cell = over_conveyor()
    cell.arm.move_until_contact(z=-0.06, force=3.0)
    seen = watched(cell, "conveyor")
    cell.arm.push(z=-force, seconds=3.0)
    forces = np.array(seen)[-150:, 0]
    assert np.abs(forces - force).max() < 0.1 * force + 0.5
    assert forces.std() < 0.3
    assert np.array(seen)[:, 0].max() < 1.5 * force + 6.0, "it hardly overshoots"


def test_pushing_begins_in_the_air_with_gain_times_force_and_stays_below_its_speed() -> None:
    cell = over_conveyor()
    heights = []
    cell.simulation.after_tick.append(lambda: heights.append(cell.truth.tool_position().z))
    cell.arm.push(z=-20.0, seconds=1.0)
    speeds = -np.diff(heights) / TICK
    assert speeds[40:80].mean() == pytest.approx(GAIN * 20.0, rel=0.05)
    heights.clear()
    cell.arm.move_by(z=0.02)
    heights.clear()
    cell.arm.push(z=-20.0, seconds=1.0, speed=0.003)
    assert (-np.diff(heights) / TICK)[40:80].mean() == pytest.approx(0.003, rel=0.05)


def test_a_push_ends_when_the_tool_has_gone_its_travel() -> None:
    cell = over_conveyor()
    before, start = cell.arm.commanded_pose(), cell.time
    cell.arm.push(z=-20.0, seconds=30.0, travel=0.005)
    assert before.z - cell.arm.commanded_pose().z == pytest.approx(0.005, abs=2e-4)
    assert cell.time - start < 2.0


def test_a_push_that_does_not_block_is_the_one_that_does() -> None:
    blocking, other = over_conveyor(), over_conveyor()
    blocking.arm.push(z=-10.0, seconds=2.0, travel=0.1, speed=0.05)
    move = other.arm.start_push(z=-10.0, seconds=2.0, travel=0.1, speed=0.05)
    assert not move.done
    move.wait()
    assert move.done
    assert blocking.truth.world() == other.truth.world()


def test_a_push_that_is_stopped_brakes_and_the_arm_is_free_for_another_motion() -> None:
    cell = over_conveyor()
    move = cell.arm.start_push(z=-200.0, seconds=5.0, travel=0.1, speed=0.05)
    cell.wait(0.2)
    assert cell.truth.tool_speed() > 0.04
    with pytest.raises(MotionRefused, match="under way"):
        cell.arm.move_by(z=0.01)
    start = cell.time
    move.stop()
    assert move.done
    assert cell.time - start < 0.05 / ACCELERATION + 0.5
    resting = cell.truth.tool_position()
    cell.wait(0.5)
    now = cell.truth.tool_position()
    assert math.dist((now.x, now.y, now.z), (resting.x, resting.y, resting.z)) < 5e-4
    cell.arm.move_by(z=0.01)


def test_along_an_axis_with_0_newton_the_tool_gives_way_and_along_the_others_it_stays() -> None:
    cell = over_conveyor()
    gripper = cell.simulation.model.body("gripper").id
    before = cell.arm.commanded_pose()
    cell.simulation.data.xfrc_applied[gripper, :2] = (8.0, 8.0)
    cell.arm.push(x=0.0, seconds=1.0, travel=0.1)
    after = cell.arm.commanded_pose()
    assert after.x - before.x == pytest.approx(GAIN * 8.0, rel=0.15)
    assert (after.y, after.z) == pytest.approx((before.y, before.z), abs=1e-6)


def test_a_push_against_what_gives_way_suddenly_is_no_leap() -> None:
    """The box under the fingers is taken away: servos that gave way spring back, 0.1 mm per N; no more."""
    cell = over_conveyor(Box(position=(0.489, 0.0, 1.0), size=(0.1, 0.1, 0.02), jitter=0.0))
    assert cell.arm.move_until_contact(z=-0.05, force=3.0)
    cell.arm.push(z=-20.0, seconds=1.0)
    cell.simulation.data.joint("box").qpos[0] += 0.5
    before = cell.truth.tool_position().z
    cell.arm.push(z=-20.0, seconds=0.5)
    assert before - cell.truth.tool_position().z < GAIN * 20.0 * 0.5 + 20.0 * 1e-4


def test_a_way_out_of_reach_is_refused_before_anything_moves() -> None:
    cell = over_conveyor()
    before = cell.time
    with pytest.raises(MotionRefused, match="reach"):
        cell.arm.move_until_contact(x=0.6)
    assert cell.time == before


def test_a_push_that_leads_out_of_reach_is_given_up_with_limit_and_excess() -> None:
    cell = over_conveyor()
    cell.arm.move_by(x=0.2)
    cell.simulation.data.xfrc_applied[cell.simulation.model.body("gripper").id, 0] = 15.0
    with pytest.raises(PathLost) as lost:
        cell.arm.push(x=60.0, seconds=60.0, travel=0.5, speed=0.05)
    assert lost.value.excess > 0
    cell.arm.home()


def test_something_that_resists_far_harder_than_asked_stops_the_arm() -> None:
    cell = over_conveyor()
    with pytest.raises(ProtectiveStop, match="touched conveyor"):
        cell.arm.move_until_contact(z=-0.06, force=200.0, speed=0.05)


@pytest.mark.parametrize(
    "ask",
    [
        lambda arm: arm.move_until_contact(),
        lambda arm: arm.move_until_contact(z=-0.01, force=0.0),
        lambda arm: arm.move_until_contact(z=-0.01, speed=0.06),
        lambda arm: arm.move_until_contact(z=math.nan),
        lambda arm: arm.push(seconds=1.0),
        lambda arm: arm.push(z=-10.0, seconds=0.0),
        lambda arm: arm.push(z=-10.0, seconds=1.0, travel=-0.01),
        lambda arm: arm.push(z="10", seconds=1.0),
    ],
)
def test_what_makes_no_sense_is_refused_at_the_border(ask: object) -> None:
    cell = Cell(1)
    with pytest.raises(BadArgument, match="Expected"):
        ask(cell.arm)  # type: ignore[operator]
    assert cell.time == 0.0
