"""A stretch of control ticks is bit by bit the same as its ticks one by one, whatever happens in it."""

from __future__ import annotations

import importlib
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from mutabot.evidence import recorder
from mutabot.evidence.recording import Recording
from mutabot_cell import (
    BadModel,
    Box,
    Cell,
    CellError,
    Fixture,
    LightBarrier,
    PathLost,
    Pose,
    ProtectiveStop,
    RobotModel,
    Scene,
    SimulationDiverged,
    gen3,
    robots,
    suction_cup,
)
from mutabot_cell.gripper import Gripper
from mutabot_cell.simulation import Simulation
from mutabot_cell.suction import Suction
from mutabot_cell.system import RobotSystem

from .memory import remembering

EXAMPLES = Path(__file__).parents[3] / "examples"
DOWN = (0.0, 26.0, 180.0, -78.0, 0.0, -76.0, 90.0)
STRETCHED = (0.0, 90.0, 180.0, 0.0, 0.0, 0.0, 90.0)
"""Joint angles, degrees: the gripper looks down over the conveyor; the arm is stretched out, level."""

Story = Callable[[Cell], None]


@dataclass
class Witness:
    """What a cell was like whenever its clock stopped, by control tick."""

    moments: dict[int, tuple[object, ...]] = field(default_factory=dict)
    longest: int = 0
    error: CellError | None = None

    def watch(self, cell: Cell) -> None:
        original = cell.simulation.tick

        def tick(most: int = 1) -> float:
            before = cell.simulation.ticks
            try:
                return original(most)
            finally:
                self.longest = max(self.longest, cell.simulation.ticks - before)
                self.moments[cell.simulation.ticks] = moment(cell)

        cell.simulation.tick = tick  # type: ignore[method-assign]


def moment(cell: Cell) -> tuple[object, ...]:
    """All that a program, a test or the next step could tell apart, bit by bit."""
    simulation, data = cell.simulation, cell.simulation.data
    number, frame = simulation.frame()
    numbers = (
        data.qpos, data.qvel, data.ctrl, data.qacc_warmstart, data.qfrc_constraint, data.qfrc_actuator,
        data.xpos, data.site_xpos, data.sensordata, data.xfrc_applied, simulation.setpoints, frame,
    )  # fmt: skip
    barriers = cell.sensors.light_barriers
    return (
        number,
        cell.truth.world(),
        [barriers.is_interrupted(name) for name in barriers.names],
        [
            (arm.commanded_joints(), *arm.guard.state())
            for arm in (system.arm for system in cell.robots.values())
        ],
        [tool.holding() for system in cell.robots.values() if (tool := _holder(system)) is not None],
        *(np.asarray(values).tobytes() for values in numbers),
    )


def _holder(system: RobotSystem) -> Gripper | Suction | None:
    return system._gripper or system._suction


def told(story: Story, make: Callable[[], Cell], *, singly: bool) -> Witness:
    cell, witness = make(), Witness()
    if singly:  # a hook of which nothing is known must see each tick
        cell.simulation.after_tick.append(lambda: None)
    witness.watch(cell)
    try:
        story(cell)
    except CellError as error:
        witness.error = error
    return witness


def check_same(story: Story, make: Callable[[], Cell] = Cell) -> Witness:
    """Tell the story tick by tick, in stretches, and each from memory; gives the one in stretches."""
    single, stretched = told(story, make, singly=True), told(story, make, singly=False)
    assert single.longest == 1
    assert stretched.longest > 1
    with remembering():
        remembered = [told(story, make, singly=singly) for singly in (True, True, False, False)]
    for found in (stretched, *remembered):
        assert max(found.moments) == max(single.moments)
        differing = [number for number, moment in found.moments.items() if moment != single.moments[number]]
        assert differing == []
        assert (type(found.error), str(found.error)) == (type(single.error), str(single.error))
        if single.error is not None:
            assert vars(found.error) == vars(single.error)
    assert remembered[-1].moments.keys() == stretched.moments.keys()
    return stretched


def paper(cell: Cell) -> None:
    """The published mission; the ROS examples make the same moves."""
    kinova, mission = _of_example("paper", "kinova", "mission")
    kinova.connect(cell)
    mission.run()


def sorting(cell: Cell) -> None:
    _of_example("pick_and_place", "sorting")[0].run(cell)


def _of_example(name: str, *modules: str) -> list[object]:
    sys.path.insert(0, str(EXAMPLES / name))
    try:
        return [importlib.import_module(module) for module in modules]
    finally:
        sys.path.pop(0)
        for module in modules:
            sys.modules.pop(module, None)


@pytest.mark.parametrize(
    ("program", "seed"),
    [
        pytest.param(paper, 1, id="paper", marks=pytest.mark.whole),
        pytest.param(sorting, 2, id="sorting"),
        pytest.param(paper, 2, id="paper in red", marks=pytest.mark.whole),
        pytest.param(sorting, 1, id="sorting in blue", marks=pytest.mark.whole),
    ],
)
def test_the_programs_of_the_examples_run_the_same(program: Story, seed: int) -> None:
    assert check_same(program, lambda: Cell(seed)).error is None


def test_a_box_that_slips_and_is_let_fall_does_so_the_same() -> None:
    check_same(sorting, lambda: Cell(3, scene=Scene(parts=(Box(colour="blue", mass=0.4, friction=0.01),))))


def test_a_collision_stops_the_arm_at_the_same_tick_with_the_same_words() -> None:
    def story(cell: Cell) -> None:
        cell.arm.move_by(y=-0.2)
        cell.arm.move_by(theta_x=80)
        cell.gripper.command(1)
        cell.arm.move_by(z=-0.4)

    found = check_same(story, lambda: Cell(finger_speed=0.02)).error
    assert isinstance(found, ProtectiveStop)
    assert found.second == "conveyor"


def test_after_a_collision_all_goes_on_the_same() -> None:
    def story(cell: Cell) -> None:
        cell.arm.move_by(theta_x=90)
        with pytest.raises(ProtectiveStop):
            cell.arm.move_by(z=-0.45)
        cell.wait(0.3)
        cell.arm.acknowledge_stop()
        cell.arm.home()

    check_same(story)


def test_an_overload_stops_the_arm_at_the_same_tick_with_the_same_words() -> None:
    def story(cell: Cell) -> None:
        cell.arm.move_joints(STRETCHED)
        cell.simulation.model.body("gripper").mass[:] += 3.6
        cell.wait(60.0)

    found = check_same(story, lambda: Cell(1, scene=Scene(parts=()))).error
    assert isinstance(found, ProtectiveStop)
    assert found.overload


def test_a_joint_that_cannot_follow_stops_the_arm_at_the_same_tick() -> None:
    def story(cell: Cell) -> None:
        cell.simulation.model.dof_frictionloss[0] = 500.0
        cell.arm.move_by(y=0.2)

    found = check_same(story).error
    assert isinstance(found, ProtectiveStop)
    assert abs(found.following_error) > 0.03


def test_a_heavy_part_that_was_declared_is_carried_the_same() -> None:
    def story(cell: Cell) -> None:
        cell.arm.move_joints(DOWN)
        pose, box = cell.arm.commanded_pose(), cell.truth.box_position()
        cell.arm.move_by(x=box.x - pose.x, y=box.y - pose.y, z=box.z + 0.03 - 0.9 - pose.z)
        cell.gripper.set_force(235)
        cell.gripper.command(1)
        cell.wait(1.5)
        cell.arm.set_payload(2.0)
        cell.arm.move_by(z=0.1)
        assert cell.gripper.holding()

    check_same(story, lambda: Cell(1, scene=Scene(parts=(Box(mass=2.0),))))


def test_friction_in_a_joint_and_wrong_encoders_are_the_same() -> None:
    def story(cell: Cell) -> None:
        cell.simulation.model.dof_frictionloss[1] = 15.0
        cell.simulation.robot.set_encoder_error((0.0, math.radians(1), 0.0, 0.0, 0.0, 0.0, 0.0))
        cell.arm.move_by(z=0.1)

    check_same(story)


def test_a_collision_soon_after_joints_began_to_rub_is_the_same() -> None:
    """What a stretch from memory is looked at for must not be told by the state before it."""

    def story(cell: Cell) -> None:
        cell.arm.move_by(theta_x=90)
        with pytest.raises(ProtectiveStop):
            cell.arm.move_by(z=-0.45)
        cell.arm.acknowledge_stop()
        cell.arm.move_by(z=0.02)
        cell.simulation.model.dof_frictionloss[1] = 15.0
        cell.arm.move_by(z=-0.1)

    assert isinstance(check_same(story).error, ProtectiveStop)


def test_a_force_from_outside_is_the_same() -> None:
    """It comes from no servo, so a stretch must keep it as it was."""

    def story(cell: Cell) -> None:
        cell.simulation.data.xfrc_applied[cell.simulation.id_of("body", "box"), 2] = 5.0
        cell.wait(0.4)
        assert cell.truth.box_position().z > 1.1

    check_same(story)


def over_the_box(cell: Cell, height: float) -> None:
    """The tool point so high over the box's bottom, m, looking down."""
    cell.arm.move_joints(DOWN)
    pose, box = cell.arm.commanded_pose(), cell.truth.box_position()
    cell.arm.move_by(x=box.x - pose.x, y=box.y - pose.y, z=box.z + height - 0.9 - pose.z)


def test_a_belt_that_starts_runs_and_stops_is_the_same() -> None:
    def story(cell: Cell) -> None:
        cell.wait(0.3)
        cell.belt().run(0.2)
        cell.arm.move_by(y=0.1)
        cell.belt().stop()
        cell.wait(1.0)
        assert cell.truth.belt_position() > 0.1

    check_same(story)


def test_nothing_is_stepped_in_a_stretch_while_a_belt_runs(cell: Cell) -> None:
    cell.belt().run(0.1)
    assert longest(cell) == 1


def test_a_belt_that_is_tracked_is_the_same() -> None:
    def story(cell: Cell) -> None:
        cell.arm.move_joints(DOWN)
        cell.belt().run(0.1)
        cell.arm.track(cell.belt())
        cell.arm.move_by(z=-0.05)
        cell.arm.stop_tracking()
        cell.belt().stop()
        cell.arm.home()

    assert check_same(story).error is None


def test_a_belt_that_leads_out_of_reach_is_lost_at_the_same_tick_with_the_same_words() -> None:
    def story(cell: Cell) -> None:
        cell.arm.move_joints(DOWN)
        cell.belt().run(0.4)
        cell.arm.track(cell.belt())
        cell.wait(10.0)

    assert isinstance(check_same(story).error, PathLost)


def test_motions_by_force_are_the_same() -> None:
    def story(cell: Cell) -> None:
        over_the_box(cell, 0.12)
        cell.gripper.command(1, wait=True)
        cell.force_sensor.zero()
        assert cell.arm.move_until_contact(z=-0.08)
        cell.arm.push(z=-10, seconds=0.3)
        cell.arm.move_by(z=0.05)

    assert check_same(story).error is None


def test_a_part_that_a_suction_cup_lifts_and_lets_fall_is_the_same() -> None:
    def story(cell: Cell) -> None:
        over_the_box(cell, 0.055)
        cell.arm.move_by(z=-0.008, speed=0.1)
        cell.suction.on()
        cell.wait(0.6)
        cell.arm.move_by(z=0.05)
        assert cell.truth.box_position().z > 1.03
        cell.suction.off()
        cell.wait(0.6)
        cell.arm.move_by(z=0.05)
        assert cell.truth.box_position().z < 1.01

    check_same(story, lambda: Cell(1, robot=gen3().with_tool(suction_cup())))


def test_nothing_is_stepped_in_a_stretch_while_a_suction_cup_draws() -> None:
    cell = Cell(1, robot=gen3().with_tool(suction_cup()))
    cell.suction.on()
    assert longest(cell) == 1


def test_a_light_barrier_that_looks_seldom_sees_the_same() -> None:
    def story(cell: Cell) -> None:
        cell.arm.move_by(z=0.2)
        cell.arm.move_by(z=-0.2)

    pose = Cell(1).arm.commanded_pose()
    gate = LightBarrier("gate", (pose.x, pose.y - 0.4, 1.5), (pose.x, pose.y + 0.4, 1.5), rate=10.0)
    found = check_same(story, lambda: Cell(1, scene=Scene(light_barriers=(gate,))))
    assert {moments[2][0] for moments in found.moments.values()} == {True, False}


@pytest.mark.parametrize("other", ["gen3", "ur5e"])
def test_robots_that_share_a_clock_are_the_same(other: str) -> None:
    """One moves while the other one does; the servos of a UR5e are fed the torques that a motion needs."""
    try:
        model: RobotModel = getattr(robots, other)()
    except BadModel as error:
        pytest.skip(str(error))

    def story(cell: Cell) -> None:
        right = cell.robots["right"].arm.start_move_by(z=0.05)
        cell.robots["left"].arm.move_by(y=0.05)
        cell.robots["left"].gripper.command(1)
        right.wait()

    beside = model.at(Pose(0.0, 1.6, 0.9, 0.0, 0.0, 0.0))
    assert check_same(story, lambda: Cell(1, robots={"left": gen3(), "right": beside})).error is None


def test_parts_that_fall_asleep_and_are_pushed_over_are_the_same() -> None:
    """A stretch sets states, but only such as there are, and that wakes nothing."""
    places = [(0.5 + 0.052 * (number % 3), 0.052 * (number // 3 % 3), number // 9) for number in range(12)]
    boxes = tuple(
        Box(name=f"box {number}", position=(x, y, 1.0 + 0.05 * layer), jitter=0.0)
        for number, (x, y, layer) in enumerate(places)
    )

    def story(cell: Cell) -> None:
        cell.wait(0.5)
        data = cell.simulation.data
        assert data.nbody_awake < data.body_awake.size
        cell.gripper.command(1, wait=True)
        cell.arm.move_joints(DOWN)
        pose = cell.arm.commanded_pose()
        cell.arm.move_by(x=0.55 - pose.x, y=-0.12 - pose.y)
        cell.arm.move_by(z=0.135 - pose.z)
        cell.arm.move_by(y=0.10, speed=0.3)
        assert cell.truth.box_position("box 9").y > 0.01

    check_same(story, lambda: Cell(1, scene=Scene(parts=boxes)))


def longest(cell: Cell) -> int:
    """The longest stretch of half a second, ticks."""
    witness = Witness()
    witness.watch(cell)
    cell.wait(0.5)
    return witness.longest


@pytest.mark.parametrize("torque", [1e3, 1e12], ids=["too fast", "MuJoCo warns"])
def test_physics_that_diverge_are_found_at_the_same_tick(torque: float) -> None:
    def story(cell: Cell) -> None:
        cell.wait(0.1)
        cell.simulation.data.qfrc_applied[-1] = torque
        cell.wait(1.0)

    single, stretched = (told(story, Cell, singly=singly) for singly in (True, False))
    assert isinstance(single.error, SimulationDiverged)
    with remembering():
        remembered = [told(story, Cell, singly=singly) for singly in (True, True, False, False)]
    for found in (stretched, *remembered):
        assert str(found.error) == str(single.error)
        assert max(found.moments) == max(single.moments)


@pytest.mark.whole
def test_a_recording_of_a_test_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:

    def recorded(*, singly: bool) -> Recording:
        running = recorder.WorldRecorder()
        monkeypatch.setattr(recorder, "running", lambda: running)
        told(paper, lambda: Cell(1), singly=singly)
        running.finish()
        return running.recording

    single = recorded(singly=True)
    assert len(single.times) > 200
    assert recorded(singly=False) == single
    with remembering():
        assert [recorded(singly=singly) for singly in (True, True, False, False)] == [single] * 4


def test_a_collision_of_one_of_two_robots_in_a_recorded_test_is_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What is recorded within a stretch must not be asked of what comes after the collision."""

    def story(cell: Cell) -> None:
        left = cell.robots["left"].arm.start_move_by(y=0.3)
        cell.robots["right"].arm.move_joints(DOWN)
        pose = cell.robots["right"].arm.commanded_pose()
        cell.robots["right"].arm.move_by(z=-0.05 - pose.z)
        left.wait()

    def make() -> Cell:
        running = recorder.WorldRecorder()
        monkeypatch.setattr(recorder, "running", lambda: running)
        beside = gen3().at(Pose(0.0, 1.6, 0.9, 0.0, 0.0, 0.0))
        plate = Fixture("plate", size=(0.4, 0.4, 0.02), centre=(0.5, 1.6, 0.89))
        scene = Scene(fixtures=(plate,))
        return Cell(1, robots={"left": gen3(), "right": beside}, scene=scene)

    assert isinstance(check_same(story, make).error, ProtectiveStop)


def test_a_driver_of_which_nothing_is_known_decides_at_each_tick(cell: Cell) -> None:
    asked = []
    cell.simulation.before_tick.append(lambda: asked.append(cell.simulation.ticks))
    cell.wait(0.5)
    assert asked == list(range(50))


def test_a_monitor_sees_each_tick_and_no_stretch_is_made_while_it_watches(cell: Cell) -> None:
    seen: list[int] = []
    watched = cell.always(lambda: seen.append(cell.simulation.ticks) is None, "seen")
    cell.wait(0.5)
    assert seen == list(range(51))
    cell.monitors.forget(watched)
    assert longest(cell) == 50


def test_no_more_ticks_pass_than_wanted(cell: Cell) -> None:
    simulation: Simulation = cell.simulation
    for most in (1, 2, 7, 1000):
        before = simulation.ticks
        simulation.tick(most)
        assert before < simulation.ticks <= before + most
    cell.wait(0.13)
    assert simulation.ticks % 100 != 0
