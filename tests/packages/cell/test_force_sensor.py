"""The force sensor reads what one between flange and tool would; expectations are derived here."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from mutabot_cell import Box, Cell, Scene
from mutabot_cell.force_sensor import Wrench
from mutabot_cell.simulation import TICK

GRAVITY = 9.81
DOWN = (0.0, 26.0, 180.0, -78.0, 0.0, -76.0, 90.0)
POSTURES = [
    DOWN,
    (0.0, 15.0, 180.0, -130.0, 0.0, 55.0, 90.0),
    (30.0, -20.0, 150.0, -80.0, 90.0, 30.0, -10.0),
    (-145.0, 26.0, 180.0, -78.0, 0.0, 90.0, 33.0),
]


def sensed(seed: int = 1, *, noise: bool = False, parts: tuple[Box, ...] = ()) -> Cell:
    return Cell(seed, noise=noise, scene=Scene(parts=parts))


def tool(cell: Cell) -> tuple[float, np.ndarray]:
    """Mass of all that hangs on the flange, kg, and its centre from the flange, world axes, m."""
    model, data = cell.simulation.model, cell.simulation.data
    flange = model.body("interface").id
    bodies = [body for body in range(model.nbody) if body == flange or _hangs_on(model, body, flange)]
    masses = model.body_mass[bodies]
    centre = (masses[:, None] * data.xipos[bodies]).sum(axis=0) / masses.sum()
    return float(masses.sum()), centre - data.xpos[flange]


def _hangs_on(model: mujoco.MjModel, body: int, flange: int) -> bool:
    while body:
        body = int(model.body_parentid[body])
        if body == flange:
            return True
    return False


def axes(cell: Cell) -> np.ndarray:
    return cell.simulation.data.body("interface").xmat.reshape(3, 3)


def numbers(wrench: Wrench) -> tuple[float, ...]:
    return (wrench.fx, wrench.fy, wrench.fz, wrench.tx, wrench.ty, wrench.tz)


@pytest.mark.parametrize("angles", POSTURES, ids=str)
def test_it_reads_the_tools_weight_in_every_orientation(angles: tuple[float, ...]) -> None:
    cell = sensed()
    cell.arm.move_joints(angles)
    cell.wait(1.0)
    mass, centre = tool(cell)
    assert mass == pytest.approx(0.9, abs=0.001), "data sheet of the gripper"
    weight = np.array([0.0, 0.0, -mass * GRAVITY])
    expected = [*(weight @ axes(cell)), *(np.cross(centre, weight) @ axes(cell))]
    assert numbers(cell.force_sensor.wrench()) == pytest.approx(expected, abs=0.02)


def test_hanging_straight_down_it_reads_the_weight_along_its_axis() -> None:
    cell = sensed()
    cell.arm.move_joints(DOWN)
    cell.wait(1.0)
    assert cell.force_sensor.wrench().fz == pytest.approx(0.9 * GRAVITY, abs=0.02)
    assert cell.force_sensor.wrench().force == pytest.approx(0.9 * GRAVITY, abs=0.02)


def test_a_part_in_the_fingers_weighs_in_and_the_grip_does_not(grip: Callable[[Cell], None]) -> None:
    cell = sensed(parts=(Box(mass=0.5),))
    grip(cell)
    cell.arm.move_by(z=0.1)
    cell.wait(1.0)
    for force in (60.0, 150.0):
        cell.gripper.set_force(force)
        cell.wait(1.0)
        assert cell.force_sensor.wrench().force == pytest.approx(1.4 * GRAVITY, abs=0.05)


def test_it_feels_the_tools_inertia_while_the_arm_accelerates() -> None:
    cell = sensed()
    cell.arm.move_joints(DOWN)
    cell.wait(0.5)
    heights, forces = [], []

    def note() -> None:
        heights.append(float(cell.simulation.data.subtree_com[cell.simulation.model.body("gripper").id][2]))
        forces.append(cell.force_sensor.wrench().fz)

    cell.simulation.after_tick.append(note)
    cell.arm.move_by(z=0.2)
    accelerations = np.diff(heights, n=2) / TICK**2
    felt = 0.9 * (GRAVITY + accelerations)
    assert np.ptp(felt) > 1.5
    assert np.abs(np.array(forces[1:-1]) - felt).mean() < 0.1


def test_what_it_presses_on_takes_weight_off_it() -> None:
    cell = sensed()
    cell.arm.move_joints(DOWN)
    cell.arm.move_by(z=0.125 - cell.arm.commanded_pose().z)
    cell.wait(0.5)
    data, model = cell.simulation.data, cell.simulation.model
    cell.force_sensor.zero()
    wrench, pressed = np.zeros(6), 0.0
    while pressed < 5.0:
        cell.arm.move_by(z=-0.001, speed=0.1)
        cell.wait(0.3)
        touching = [index for index in range(data.ncon) if "conveyor" in _names(model, data, index)]
        pressed = 0.0
        for index in touching:
            mujoco.mj_contactForce(model, data, index, wrench)
            pressed += float(wrench[0])
    assert cell.force_sensor.wrench().fz == pytest.approx(-pressed, rel=0.05)


def _names(model: mujoco.MjModel, data: mujoco.MjData, index: int) -> set[str]:
    return {model.geom(geom).name for geom in data.contact.geom[index].tolist()}


def test_zeroed_it_reads_nothing_until_the_tool_is_turned() -> None:
    cell = sensed()
    cell.arm.move_joints(DOWN)
    cell.wait(1.0)
    cell.force_sensor.zero()
    cell.wait(0.5)
    assert cell.force_sensor.wrench().force < 0.02
    cell.arm.move_joints((*DOWN[:5], DOWN[5] + 60.0, DOWN[6]))
    cell.wait(1.0)
    change = 2 * math.sin(math.radians(60.0) / 2) * 0.9 * GRAVITY
    assert cell.force_sensor.wrench().force == pytest.approx(change, rel=0.05)


def test_it_reads_once_per_tick_with_the_makers_noise() -> None:
    cell = sensed(noise=True)
    cell.wait(0.5)
    assert len({cell.force_sensor.wrench() for _ in range(20)}) == 1
    readings = []
    for _ in range(400):
        cell.simulation.tick()
        readings.append(cell.force_sensor.wrench())
    assert statistics.stdev(reading.fx for reading in readings) == pytest.approx(0.1, rel=0.15)
    assert statistics.stdev(reading.ty for reading in readings) == pytest.approx(0.005, rel=0.15)


def test_beyond_its_range_it_reads_the_end_of_it() -> None:
    cell = sensed()
    cell.arm.move_joints(DOWN)
    cell.wait(0.5)
    cell.simulation.model.opt.gravity[2] = -400.0  # 0.9 kg would read 360 N
    mujoco.mj_forward(cell.simulation.model, cell.simulation.data)
    assert cell.force_sensor.wrench().fz == 300.0


def test_reading_it_changes_nothing() -> None:
    ends = []
    for reads in (False, True):
        cell = sensed(parts=(Box(),))
        if reads:
            cell.simulation.after_tick.append(cell.force_sensor.wrench)
        cell.arm.move_by(y=0.2)
        ends.append(cell.simulation.data.qpos.tobytes())
    assert ends[0] == ends[1]
