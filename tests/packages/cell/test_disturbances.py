"""Disturbances of a cell do what they say: the physics is that of a cell that was built so."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from random import Random
from typing import Any

import mujoco
import numpy as np
import pytest

import mutabot_cell
from mutabot_cell import Belt, Box, Cell, Scene, SensorError, disturbances, sensor_disturbances
from mutabot_cell.scene import CONVEYOR, TARGET_TABLE
from mutabot_cell.simulation import TICK
from mutabot_world.change import NumberChange
from mutabot_world.tables import ParameterFile, ParameterTable
from mutabot_world.units import in_si

SHIPPED = Path(mutabot_cell.__file__).with_name("world.toml")
PARAMETERS = ParameterFile.model_validate(tomllib.loads(SHIPPED.read_text(encoding="utf-8"))).parameter
BOX = Box(position=(0.55, 0.2, 1.0), jitter=0.0)


def disturb(cell: Any, function: str, kind: str, amount: float, names: str = "*", **options: Any) -> None:
    """Call a disturbance as the tests' process does."""
    found = getattr(disturbances, function, None) or getattr(sensor_disturbances, function)
    found(cell, NumberChange(kind, amount), names=names, random=Random(1), **options)


def pairs(cell: Cell) -> dict[tuple[str, str], float]:
    """Sliding friction by the names of the two shapes."""
    model = cell.simulation.model
    ends = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
    return {
        (model.geom(first).name, model.geom(second).name): float(model.pair_friction[number, 0])
        for number, (first, second) in enumerate(ends)
    }


def test_the_paper_s_list_is_offered() -> None:
    names = {parameter.name for parameter in PARAMETERS}
    assert names >= {
        "table height", "conveyor x", "payload", "centre of mass", "belt speed", "belt jitter", "camera bias",
        "camera scale", "camera drift", "camera dropout", "occlusion", "actuation delay",
    }  # fmt: skip


@pytest.mark.parametrize("parameter", PARAMETERS, ids=lambda parameter: parameter.name)
def test_each_shipped_parameter_applies_or_says_what_is_not_there(parameter: ParameterTable) -> None:
    assert parameter.apply is not None
    module, _, name = parameter.apply.partition(":")
    sign = -1.0 if parameter.ways == ("-",) else 1.0
    change = NumberChange(parameter.change, sign * in_si(parameter.ladder[0], parameter.measure))
    told = {"names": parameter.names, "random": Random(1), **parameter.options}
    function, making = getattr(import_module(module), name), dict[str, Any](seed=3)
    if parameter.when == "making":
        function(making, change, **told)
        assert making["scene"] != Scene()
        return
    with Cell(**making) as cell:
        if parameter.name == "vacuum leak":
            with pytest.raises(LookupError, match="suction cup"):
                function(cell, change, **told)
            return
        function(cell, change, **told)
        cell.wait(0.05)


def test_a_heavier_part_is_as_one_that_was_built_so() -> None:
    with Cell(3) as cell, Cell(3, scene=Scene(parts=(Box(mass=0.4),))) as built:
        disturb(cell, "part_mass", "offset", 0.3)
        expected, actual = cell.simulation.model, built.simulation.model
        for field in ("body_mass", "body_inertia", "body_invweight0", "dof_invweight0", "body_subtreemass"):
            np.testing.assert_allclose(
                getattr(expected, field), getattr(actual, field), rtol=1e-9, err_msg=field
            )
        np.testing.assert_array_equal(cell.simulation.data.qpos, built.simulation.data.qpos)


def test_friction_in_the_grip_is_that_of_pairs_with_pads_alone() -> None:
    with Cell(3) as cell:
        before = pairs(cell)
        disturb(cell, "friction_of_pads", "scale", -0.5)
        changed = {key for key, friction in pairs(cell).items() if friction != before[key]}
    assert changed
    assert all(any("pad" in name for name in pair) for pair in changed)


def test_a_worn_gripper_stays_worn_when_its_force_is_set() -> None:
    with Cell(3) as cell:
        disturb(cell, "grip_force", "scale", -0.75)
        cell.gripper.set_force(100.0)
        limits = cell.simulation.model.actuator_forcerange[cell.simulation.robot.fingers]
        whole = limits[1]
        cell.gripper.set_strength(1.0)
        assert whole == pytest.approx(0.25 * limits[1])


def test_a_fixture_takes_along_what_stands_on_it() -> None:
    with Cell(3, scene=Scene(parts=(BOX,))) as cell:
        before = cell.truth.box_position()
        disturb(cell, "fixture_position", "offset", 0.02, "conveyor", axis="z")
        assert cell.truth.box_position().z - before.z == pytest.approx(0.02)
        cell.wait(0.3)
        assert cell.truth.box_position().z == pytest.approx(CONVEYOR.centre[2] + 0.05 + 0.02, abs=0.001)


def test_what_stands_on_a_turned_fixture_keeps_its_pose_in_the_fixture_s_frame() -> None:
    x, y, z = TARGET_TABLE.centre
    beside = Box(name="beside", position=(x, y, z + TARGET_TABLE.size[2] / 2 + 0.03), jitter=0.0)
    with Cell(3, scene=Scene(parts=(BOX, beside))) as cell:
        relative, far = pose_in(cell, "conveyor", "box"), cell.simulation.data.joint("beside").qpos.tolist()
        turned = cell.simulation.data.body("box").xpos.copy()
        disturb(cell, "fixture_angle", "offset", np.radians(5.0), "conveyor")
        np.testing.assert_allclose(pose_in(cell, "conveyor", "box"), relative, atol=1e-12)
        assert cell.simulation.data.joint("beside").qpos.tolist() == far
        _, _, _, w, x, y, z = cell.simulation.data.joint("box").qpos.tolist()
        assert 2 * np.degrees(np.arctan2(z, w)) == pytest.approx(5.0)
        assert (cell.simulation.data.body("box").xpos[:2] != turned[:2]).any()


def pose_in(cell: Cell, fixture: str, part: str) -> list[float]:
    """Return position and rotation matrix of a part in the frame of a fixture, 12 numbers."""
    data = cell.simulation.data
    frame = data.body(fixture).xmat.reshape(3, 3)
    place = frame.T @ (data.body(part).xpos - data.body(fixture).xpos)
    return [*place, *(frame.T @ data.body(part).xmat.reshape(3, 3)).ravel()]


def test_a_part_may_lie_elsewhere_be_turned_and_be_larger() -> None:
    making: dict[str, Any] = {"seed": 3, "scene": Scene(parts=(BOX,))}
    disturb(making, "part_size", "offset", 0.01)
    disturb(making, "part_centre_of_mass", "offset", 0.005, axis="x")
    with Cell(**making) as cell:
        part = cell.simulation.scene.parts[0]
        assert isinstance(part, Box)
        assert part.size == pytest.approx((0.06, 0.06, 0.06))
        assert part.centre_of_mass == (0.005, 0.0, 0.0)
        before = cell.truth.box_position()
        disturb(cell, "part_position", "offset", 0.02, axis="y")
        disturb(cell, "part_angle", "offset", np.radians(30.0))
        assert cell.truth.box_position().y - before.y == pytest.approx(0.02)
        _, _, _, w, x, y, z = cell.simulation.data.joint("box").qpos.tolist()
        assert 2 * np.degrees(np.arctan2(z, w)) == pytest.approx(30.0)
        assert (x, y) == pytest.approx((0.0, 0.0))


def test_the_controller_knows_nothing_of_a_moved_base_or_tool() -> None:
    with Cell(3, noise=False) as cell:
        pad, read = cell.simulation.data.geom("left pad"), cell.sensors.tool_pose()
        before = pad.xpos.copy()
        disturb(cell, "base_position", "offset", 0.01, axis="x")
        disturb(cell, "tool_position", "offset", 0.005, axis="z")
        assert cell.sensors.tool_pose() == read
        moved = pad.xpos - before
        assert np.linalg.norm(moved - (0.01, 0.0, 0.0)) == pytest.approx(0.005, abs=1e-6)


def test_servos_get_their_setpoints_later_and_no_stop_comes_of_that_alone() -> None:
    ends = []
    for delay in (0.0, 0.1):
        with Cell(3, noise=False) as cell:
            disturb(cell, "actuation_delay", "set", delay)
            cell.arm.move_by(y=0.1)
            ends.append(cell.truth.tool_position().y)
            cell.wait(0.5)
            assert cell.truth.tool_position().y == pytest.approx(ends[0], abs=0.002)
    assert ends[1] < ends[0] - 0.0001 or ends[1] == pytest.approx(ends[0], abs=0.001)


def test_a_joint_with_play_does_not_follow_small_motions() -> None:
    with Cell(3, noise=False) as cell:
        disturb(cell, "backlash", "set", np.radians(2.0), joint=1)
        before = cell.simulation.data.qpos[0]
        home = list(np.degrees(cell.simulation.robot.model.home))
        cell.arm.move_joints((home[0] + 0.8, *home[1:]))
        assert np.degrees(cell.simulation.data.qpos[0] - before) == pytest.approx(0.0, abs=0.05)


def test_a_belt_is_faster_and_its_encoder_wrong() -> None:
    scene = Scene(fixtures=(replace(CONVEYOR, belt=Belt()), TARGET_TABLE), parts=())
    with Cell(3, scene=scene) as cell:
        disturb(cell, "belt_speed", "scale", 0.1)
        disturb(cell, "belt_encoder", "scale", 0.5)
        cell.belt().run(0.1)
        cell.wait(2.0)
        assert cell.truth.belt_speed() == pytest.approx(0.11)
        assert cell.belt().position() == pytest.approx(1.5 * cell.truth.belt_position(), abs=2e-4)
        disturb(cell, "belt_jitter", "set", 0.2)
        cell.wait(1.0)
        assert cell.truth.belt_speed() != pytest.approx(0.11, abs=1e-6)


def test_the_camera_has_a_bias_a_scale_and_a_drift() -> None:
    with Cell(3, noise=False) as cell:
        true = cell.truth.box_position()
        disturb(cell, "bias", "offset", 0.01, sensor="box position", axis="y")
        seen = cell.sensors.box_position()
        assert (seen.x - true.x, seen.y - true.y, seen.z - true.z) == pytest.approx((0.0, 0.01, 0.0))
    with Cell(3, noise=False) as cell:
        disturb(cell, "bias", "scale", 0.1, sensor="box position")
        assert cell.sensors.box_position().z == pytest.approx(1.1 * true.z)
    with Cell(3, noise=False) as cell:
        disturb(cell, "drift", "offset", 0.002, sensor="box position", axis="x")
        cell.wait(2.0)
        assert cell.sensors.box_position().x - true.x == pytest.approx(0.004, abs=2e-4)


def test_the_camera_misses_pictures_and_is_blind_for_a_time() -> None:
    with Cell(3) as cell:
        disturb(cell, "dropout", "set", 1.0)
        with pytest.raises(SensorError):
            cell.sensors.box_position()
    with Cell(3) as cell:
        disturb(cell, "outage", "set", 0.5, begin=1.0)
        cell.wait(0.9)
        cell.sensors.box_position()
        cell.wait(0.3)
        with pytest.raises(SensorError):
            cell.sensors.box_position()
        cell.wait(0.5)
        cell.sensors.box_position()


@pytest.mark.parametrize(("radius", "is_seen"), [(0.005, True), (0.1, False)])
def test_what_stands_in_the_line_of_sight_hides_a_part(radius: float, is_seen: bool) -> None:
    with Cell(3) as cell:
        disturb(cell, "occlusion", "set", radius)
        if is_seen:
            cell.sensors.box_position()
        else:
            with pytest.raises(SensorError):
                cell.sensors.box_position()


def test_pictures_are_later_and_farther_apart() -> None:
    with Cell(3) as cell:
        disturb(cell, "latency", "offset", 0.2)
        cell.wait(1.0)
        assert cell.time - cell.sensors.picture_time() == pytest.approx(0.24, abs=0.041)
        disturb(cell, "interval", "set", 0.4)
        times = set()
        for _ in range(100):
            cell.wait(TICK)
            times.add(round(cell.sensors.picture_time(), 6))
        assert np.diff(sorted(times))[1:] == pytest.approx(0.4)


def test_nothing_changes_by_nothing() -> None:
    with Cell(3) as cell, Cell(3) as other:
        disturb(cell, "part_mass", "offset", 0.0)
        disturb(cell, "base_position", "offset", 0.0, axis="x")
        for changed_cell in (cell, other):
            changed_cell.arm.move_by(y=0.02)
        state = mujoco.mjtState.mjSTATE_PHYSICS
        found = []
        for changed_cell in (cell, other):
            values = np.zeros(mujoco.mj_stateSize(changed_cell.simulation.model, state))
            mujoco.mj_getState(changed_cell.simulation.model, changed_cell.simulation.data, values, state)
            found.append(values)
        np.testing.assert_array_equal(*found)
