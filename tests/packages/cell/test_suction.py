"""A suction cup holds by vacuum times area, and by nothing else; each expectation is derived here."""

from __future__ import annotations

import math
import statistics
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

from mutabot_cell import BadArgument, Box, Cell, Fixture, Pose, ProtectiveStop, Scene, gen3, suction_cup
from mutabot_cell.models.cup import PRELOAD, STIFFNESS
from mutabot_cell.models.kinova import TOOL_ACCELERATION
from mutabot_cell.models.tool import Tool
from mutabot_cell.models.vacuum import Ejector
from mutabot_cell.parts import Part
from mutabot_cell.scene import CONVEYOR

GRAVITY = 9.81
DOWN = (0.0, 26.0, 180.0, -78.0, 0.0, -76.0, 90.0)
CUP = suction_cup(0.030, ejector=Ejector(limit=60e3))
FORCE = 60e3 * math.pi * 0.015**2
"""Vacuum times area, N."""


def place(
    mass: float, size: tuple[float, float, float] = (0.1, 0.1, 0.04), friction: float | None = None
) -> Box:
    return Box(mass=mass, size=size, position=(0.5, 0.1, 1.0), jitter=0.0, friction=friction)


def above(part: Part, cup: Tool = CUP, *, off: float = 0.0, noise: bool = False) -> Cell:
    """The cup pressed on the part from above, 3 mm deep, `off` m beside its middle along y."""
    robot = gen3().with_tool(cup)
    cell = Cell(1, noise=noise, scene=Scene(parts=(part,)), robot=robot)
    cell.arm.move_joints(DOWN)
    pose, box = cell.arm.commanded_pose(), cell.truth.box_position()
    cell.arm.move_by(x=box.x - pose.x, y=box.y + off - pose.y)
    cell.arm.move_by(z=box.z + part.extent[2] - 0.9 + 0.005 - pose.z)
    cell.arm.move_by(z=-0.008, speed=0.1)
    return cell


def held(part: Part, cup: Tool = CUP, *, off: float = 0.0) -> Cell:
    """The part lifted by the cup, if that can."""
    cell = above(part, cup, off=off)
    cell.suction.on()
    cell.wait(1.0)
    cell.arm.set_payload(part.mass)
    cell.arm.move_by(z=0.1, speed=0.1)
    return cell


def test_a_30_mm_cup_at_60_kpa_holds_vacuum_times_area_and_not_more() -> None:
    assert round(FORCE, 1) == 42.4
    cell = held(place(0.5))
    cell.arm.set_payload(2.0)  # the arm bears the pull, within what it takes for a collision
    data, weight = cell.simulation.data, 0.5 * GRAVITY
    down = cell.simulation.model.joint("box").dofadr[0] + 2
    for pull in np.arange(0.0, 1.2 * FORCE, 0.2).tolist():
        data.qfrc_applied[down] = weight - pull
        cell.simulation.tick()
        if not cell.suction.holding():
            break
    assert pull == pytest.approx(FORCE, rel=0.05)


def test_the_part_hangs_on_the_lip_with_its_weight_and_the_cup_presses_on_it_with_the_rest() -> None:
    import mujoco  # noqa: PLC0415  # an extra

    cell = held(place(1.0))
    cell.wait(0.5)
    model, data, wrench = cell.simulation.model, cell.simulation.data, np.zeros(6)
    pressed = 0.0
    for index in range(data.ncon):
        names = {model.geom(geom).name for geom in data.contact.geom[index].tolist()}
        if "box" in names and any(name.startswith("lip") for name in names):
            mujoco.mj_contactForce(model, data, index, wrench)
            pressed += float(wrench[0])
    assert pressed == pytest.approx(FORCE - 1.0 * GRAVITY, rel=0.01)


def test_what_the_vacuum_does_to_the_part_it_does_to_the_cup_the_other_way() -> None:
    cell = held(place(1.0), off=0.01)
    data, model = cell.simulation.data, cell.simulation.model
    pulls = data.xfrc_applied
    assert np.linalg.norm(pulls[model.body("box").id, :3]) == pytest.approx(FORCE, rel=0.001)
    assert np.abs(pulls[:, :3].sum(axis=0)).max() < 1e-9
    moments = pulls[:, 3:] + np.cross(data.xipos, pulls[:, :3])
    assert np.abs(moments.sum(axis=0)).max() < 1e-9


@pytest.mark.parametrize(("share", "lifts"), [(0.75, True), (1.05, False)])
def test_a_part_is_lifted_if_vacuum_times_area_bears_its_weight_and_inertia(
    share: float, lifts: bool
) -> None:
    assert (share * (GRAVITY + TOOL_ACCELERATION) < GRAVITY) == lifts
    cup = suction_cup(0.020, ejector=Ejector(limit=60e3))
    cell = held(place(share * 60e3 * math.pi * 0.010**2 / GRAVITY), cup)
    cell.wait(1.0)
    assert (cell.truth.box_position().z > 1.08) == lifts
    assert cell.suction.holding() == lifts


def test_a_cup_over_an_edge_leaks_and_lifts_nothing() -> None:
    for off, lifts in ((0.030, True), (0.045, False)):
        assert (off + 0.015 < 0.05) == lifts, "the part ends 50 mm beside its middle"
        cell = held(place(0.1), off=off)
        assert cell.suction.holding() == lifts
        assert (cell.truth.box_position().z > 1.08) == lifts
        if not lifts:
            assert cell.suction.true_vacuum() < 5e3


def test_a_cup_loses_a_part_that_slips_to_its_edge() -> None:
    cell = held(place(0.2))
    assert cell.suction.holding()
    joint = cell.simulation.data.joint("box")
    joint.qpos[1] += 0.045
    cell.wait(0.5)
    assert not cell.suction.holding()
    assert cell.truth.box_position().z < 1.08


def test_a_worn_lip_leaves_less_vacuum_and_holds_less() -> None:
    vacuums = []
    for leak, lifts in ((0.0, True), (1e-6, False)):
        cell = held(place(2.5), suction_cup(leak=leak))
        vacuums.append(cell.suction.true_vacuum() if lifts else 0.0)
        assert (cell.truth.box_position().z > 1.08) == lifts
    sealed = above(place(2.5), suction_cup(leak=1e-6))
    sealed.suction.on()
    sealed.wait(2.0)
    pressure, ejector = sealed.suction.true_vacuum(), Ejector()
    drawn = ejector.flow * (1 - pressure / ejector.limit)
    assert drawn == pytest.approx(0.6 * 1e-6 * math.sqrt(2 * pressure / 1.2), rel=0.01)
    assert pressure * math.pi * 0.015**2 < 2.5 * GRAVITY * 1.5 < vacuums[0] * math.pi * 0.015**2 * 1.5


@pytest.mark.parametrize(("share", "holds"), [(0.8, True), (1.2, False)])
def test_sideways_the_lip_carries_friction_times_force(share: float, holds: bool) -> None:
    """With the cup's axis level, a flat part hangs by friction alone: Coulomb."""
    mass = share * 0.5 * FORCE / GRAVITY
    cell = held(place(mass, size=(0.1, 0.1, 0.01)))
    with suppress(ProtectiveStop):  # an arm that has lost the load that was declared stops
        cell.arm.move_by(theta_y=90, speed=0.5)
        cell.wait(1.0)
    assert cell.suction.holding() == holds
    assert (cell.truth.box_position().z > 1.1) == holds


def test_an_oily_part_can_be_lifted_but_not_be_held_sideways() -> None:
    oily = replace(place(0.3, size=(0.1, 0.1, 0.01)), friction=0.05)
    assert 0.05 * FORCE < 0.3 * GRAVITY < 0.5 * FORCE
    cell = held(oily)
    assert cell.suction.holding()
    cell.arm.move_by(theta_y=90, speed=0.5)
    cell.wait(1.0)
    assert not cell.suction.holding()


@pytest.mark.parametrize(("share", "holds"), [(0.7, True), (1.2, False)])
def test_a_part_peels_off_when_its_weight_tilts_it_more_than_the_cup_holds(share: float, holds: bool) -> None:
    """The lip presses with what force exceeds weight: at its edge, against the weight beside it."""
    mass = 2.0
    off = share * (FORCE - mass * GRAVITY) * 0.015 / (mass * GRAVITY)
    cell = held(place(mass, size=(0.2, 0.2, 0.02)), off=off)
    cell.wait(1.0)
    assert cell.suction.holding() == holds
    assert (cell.truth.box_position().z > 1.06) == holds


def test_off_means_that_the_part_falls_freely_after_some_hundredths_of_a_second() -> None:
    cell = held(place(0.5))
    cell.suction.off()
    heights = []
    for _ in range(14):
        cell.simulation.tick()
        heights.append(cell.truth.box_position().z)
    falls = np.diff(heights, n=2)[-5:] / 0.01**2
    assert falls == pytest.approx([-GRAVITY] * 5, rel=0.02)


def test_the_plunger_gives_way_with_its_springs_force_when_the_cup_is_pressed_down() -> None:
    cell = above(place(0.5))
    compressed = float(cell.simulation.data.joint("plunger").qpos[0])
    assert compressed == pytest.approx(0.003, abs=0.001)
    model, data = cell.simulation.model, cell.simulation.data
    spring = PRELOAD + STIFFNESS * compressed
    assert -float(data.qfrc_spring[model.joint("plunger").dofadr[0]]) == pytest.approx(spring, rel=0.05)


def test_a_part_stays_in_its_place_under_the_cup_while_the_arm_moves() -> None:
    cell = held(place(1.0))
    data = cell.simulation.data

    def seen() -> np.ndarray:
        cup = data.body("cup")
        return cup.xmat.reshape(3, 3).T @ (data.body("box").xpos - cup.xpos)

    for move in ({"y": -0.4}, {"theta_z": 60.0}, {"x": -0.1, "y": 0.2}, {"z": 0.1}):
        before = seen()
        cell.arm.move_by(**move)
        assert np.linalg.norm(seen() - before) < 0.0005


def test_the_cup_sucks_itself_to_a_table_too_and_the_arm_takes_no_harm() -> None:
    plate = Fixture("plate", (0.3, 0.3, 0.02), (0.5, 0.1, 1.03))
    robot = gen3().with_tool(CUP)
    cell = Cell(1, scene=Scene(fixtures=(CONVEYOR, plate), parts=()), robot=robot)
    cell.arm.move_joints(DOWN)
    pose = cell.arm.commanded_pose()
    cell.arm.move_by(x=0.5 - pose.x, y=0.1 - pose.y)
    cell.arm.move_by(z=1.04 - 0.9 - 0.003 - pose.z, speed=0.2)
    cell.suction.on()
    cell.wait(1.0)
    assert cell.suction.holding()


def test_the_vacuum_sensor_reads_once_per_tick_with_noise() -> None:
    cell = above(place(0.5), noise=True)
    assert len({cell.suction.vacuum() for _ in range(20)}) == 1
    readings = []
    for _ in range(400):
        cell.simulation.tick()
        readings.append(cell.suction.vacuum())
    assert statistics.stdev(readings) == pytest.approx(200.0, rel=0.15)
    assert statistics.mean(readings) == pytest.approx(0.0, abs=40.0)


def test_the_switch_reports_a_part_from_55_kpa_until_it_falls_below_54() -> None:
    cell = above(place(0.5), suction_cup())
    cell.suction.on()
    rising = []
    while not cell.suction.holding():
        rising.append(cell.suction.true_vacuum())
        cell.simulation.tick()
    assert max(rising) <= 55e3 < cell.suction.true_vacuum()
    cell.suction.off()
    while cell.suction.holding():
        last = cell.suction.true_vacuum()
        cell.simulation.tick()
    assert cell.suction.true_vacuum() <= 54e3 < last


def test_same_commands_give_a_bit_identical_run() -> None:
    runs = []
    for _ in range(2):
        cell = held(place(1.0), off=0.01)
        runs.append((cell.simulation.data.qpos.tobytes(), cell.suction.true_vacuum(), cell.time))
    assert runs[0] == runs[1]


def test_the_distance_sensor_looks_through_the_cup() -> None:
    cell = above(place(0.5))
    tool = cell.truth.tool_position()
    cell.arm.move_by(z=0.05)
    cell.wait(0.3)
    assert cell.sensors.distance() == pytest.approx(0.06 + tool.z + 0.05 + 0.9 - 1.04, abs=0.002)


def test_tool_and_vacuum_are_in_the_final_state_of_the_world() -> None:
    cell = held(place(0.5))
    world = cell.truth.world()
    assert world["vacuum"] == pytest.approx(cell.suction.true_vacuum() / 1e5)
    assert 1e3 * world["force"] == pytest.approx(cell.truth.wrench().force)
    assert cell.truth.vacuum() == cell.suction.true_vacuum()


def test_a_cell_with_a_cup_has_no_gripper_and_one_with_a_gripper_no_cup() -> None:
    with pytest.raises(BadArgument, match="no gripper"):
        above(place(0.5)).gripper  # noqa: B018
    with pytest.raises(BadArgument, match="no suction cup"):
        Cell(1).suction  # noqa: B018


def test_each_of_several_robots_has_its_own_tool() -> None:
    opposite = gen3().at(Pose(1.4, 0.0, 0.9, 0.0, 0.0, 180.0))
    cell = Cell(1, noise=False, robots={"left": gen3().with_tool(CUP), "right": opposite})
    cell.robots["left"].suction.on()
    cell.robots["right"].gripper.command(1.0)
    cell.wait(1.0)
    assert cell.truth.vacuum("left") > 0.0 == cell.truth.vacuum("right")
    assert cell.truth.opening("right") < 0.01
    weights = [cell.robots[name].force_sensor.wrench().force for name in ("left", "right")]
    assert weights == pytest.approx([0.25 * GRAVITY, 0.9 * GRAVITY], abs=0.05)
