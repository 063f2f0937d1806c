"""Parts and fixtures obey rigid-body mechanics; each expectation is derived here."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from mutabot_cell import BadArgument, Box, Cell, Cylinder, Fixture, Mesh, Scene
from mutabot_cell.models.parts import ROLLING, read_mesh
from mutabot_cell.parts import Part
from mutabot_cell.placing import move_fixture
from mutabot_cell.scene import CONVEYOR, TARGET_TABLE

GRAVITY = 9.81
ON_TABLE = (-0.6, 0.3, 0.76)
HEXAGON = tuple(
    (0.03 * math.cos(angle), 0.03 * math.sin(angle), z)
    for angle in np.radians(range(0, 360, 60)).tolist()
    for z in (0.0, 0.04)
)


def tilted(cell: Cell, degrees: float) -> Cell:
    """Gravity is tilted instead of the surface: downhill is +x."""
    slope = math.radians(degrees)
    cell.simulation.model.opt.gravity[:] = (GRAVITY * math.sin(slope), 0, -GRAVITY * math.cos(slope))
    return cell


def on_table(part: Part, degrees: float = 0.0) -> Cell:
    return tilted(Cell(1, scene=Scene(parts=(part,))), degrees)


def test_a_box_has_three_edges_and_the_inertia_that_goes_with_them() -> None:
    x, y, z = 0.3, 0.2, 0.1
    cell = on_table(Box(size=(x, y, z), mass=2.0, position=ON_TABLE))
    body = cell.simulation.model.body("box")
    expected = [2.0 / 12 * (y * y + z * z), 2.0 / 12 * (x * x + z * z), 2.0 / 12 * (x * x + y * y)]
    assert body.mass[0] == pytest.approx(2.0)
    assert body.inertia == pytest.approx(expected)
    assert cell.truth.box_position().z == pytest.approx(0.76)
    assert cell.simulation.data.body("box").xpos[2] == pytest.approx(0.76 + z / 2)


@pytest.mark.parametrize(
    ("part", "inertia"),
    [
        (Cylinder(mass=0.6, diameter=0.05, height=0.1), 0.6 * 0.025**2 / 2),
        (Mesh(mass=0.6, vertices=HEXAGON), 0.6 * 5 / 12 * 0.03**2),  # regular hexagonal prism
    ],
)
def test_cylinders_and_meshes_have_the_inertia_of_their_shape_about_their_axis(
    part: Part, inertia: float
) -> None:
    model = on_table(part).simulation.model
    turned, about = np.zeros(9), model.body("box").inertia
    mujoco.mju_quat2Mat(turned, model.body("box").iquat)
    axes = turned.reshape(3, 3)
    assert (axes @ np.diag(about) @ axes.T)[2, 2] == pytest.approx(inertia, rel=1e-5)


@pytest.mark.parametrize("angles", [(0, 0, 30), (90, 0, 0), (-90, 0, 20), (180, 0, 0)])
@pytest.mark.parametrize(
    "part",
    [Box(size=(0.1, 0.06, 0.03)), Cylinder(height=0.08), Mesh(vertices=HEXAGON)],
    ids=["box", "cylinder", "mesh"],
)
def test_however_a_part_is_turned_it_is_placed_where_it_touches_what_it_rests_on(
    part: Part, angles: tuple[float, float, float]
) -> None:
    cell = on_table(replace(part, position=ON_TABLE, angles=angles, jitter=0.0))
    assert cell.truth.box_position().z == pytest.approx(0.76)
    assert cell.truth.box_tilt() == pytest.approx(0.0, abs=1e-5)
    before = cell.simulation.data.body("box").xpos.copy()
    cell.wait(0.5)
    assert cell.simulation.data.body("box").xpos == pytest.approx(before, abs=3e-4)
    assert cell.truth.box_tilt() < 0.5


@pytest.mark.parametrize("slope", [3.0, 6.0])
def test_a_lying_cylinder_rolls_as_mechanics_says(slope: float) -> None:
    """A solid one accelerates with two thirds of what drives it: gravity less the rolling resistance c/r."""
    cell = on_table(Cylinder(position=ON_TABLE, angles=(90, 0, 0), jitter=0.0), slope)
    cell.wait(0.5)
    drive = math.sin(math.radians(slope)) - ROLLING / 0.025 * math.cos(math.radians(slope))
    assert cell.truth.box_position().z != pytest.approx(0.76), "its foot has turned with it"
    moved = cell.simulation.data.body("box").xpos[0] - ON_TABLE[0]
    assert moved == pytest.approx(2 / 3 * GRAVITY * drive * 0.5**2 / 2, rel=0.03)


def test_rolling_resistance_holds_a_cylinder_on_a_slope_below_c_over_r() -> None:
    for slope, rolls in ((0.8, False), (1.6, True)):
        assert (math.tan(math.radians(slope)) > ROLLING / 0.025) == rolls
        cell = on_table(Cylinder(position=ON_TABLE, angles=(90, 0, 0), jitter=0.0), slope)
        cell.wait(1.0)
        assert (cell.simulation.data.body("box").xpos[0] - ON_TABLE[0] > 0.01) == rolls


@pytest.mark.parametrize(
    "part", [Box(position=ON_TABLE), Cylinder(position=ON_TABLE)], ids=["box", "standing"]
)
def test_neither_a_box_nor_a_standing_cylinder_rolls(part: Part) -> None:
    cell = on_table(part, 6.0)
    before = cell.truth.box_position().x
    cell.wait(0.5)
    assert cell.truth.box_position().x == pytest.approx(before, abs=1e-4)


@pytest.mark.parametrize("offset", [0.0, 0.010, 0.020])
def test_a_box_tips_at_the_angle_at_which_its_centre_of_mass_is_above_its_edge(offset: float) -> None:
    width, height = 0.05, 0.20
    steepest = math.degrees(math.atan2(width / 2 - offset, height / 2))
    for slope, tips in ((steepest - 0.5, False), (steepest + 0.5, True)):
        box = Box(position=ON_TABLE, size=(width, width, height), centre_of_mass=(offset, 0, 0))
        cell = on_table(box, slope)
        cell.wait(1.5)
        assert (cell.truth.box_tilt() > 45) == tips


def test_a_centre_of_mass_can_be_changed_while_the_cell_runs() -> None:
    """Only where the part was built with one: MuJoCo takes a shortcut for uniform parts."""
    box = Box(position=ON_TABLE, size=(0.05, 0.05, 0.2), centre_of_mass=(0.0, 0.0, 0.0))
    cell = on_table(box, 10.0)
    cell.wait(0.5)
    assert cell.truth.box_tilt() < 1
    cell.simulation.model.body("box").ipos[0] = 0.015
    mujoco.mj_setConst(cell.simulation.model, mujoco.MjData(cell.simulation.model))
    cell.wait(1.5)
    assert cell.truth.box_tilt() > 45


def test_the_mass_of_a_part_alone_does_not_change_how_it_tips() -> None:
    for mass in (0.05, 5.0):
        cell = on_table(Box(position=ON_TABLE, size=(0.05, 0.05, 0.2), mass=mass), 13.5)
        cell.wait(1.0)
        assert cell.truth.box_tilt() < 1


def test_a_mesh_is_read_from_a_file_in_its_unit(tmp_path: Path) -> None:
    file = tmp_path / "wedge.obj"
    corners = ((0, 0, 0), (100, 0, 0), (0, 50, 0), (0, 0, 30))
    faces = ((1, 3, 2), (1, 2, 4), (1, 4, 3), (2, 3, 4))
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a} {b} {c}" for a, b, c in faces]
    file.write_text("\n".join(lines))
    part = Mesh(vertices=read_mesh(str(file), scale=0.001))
    assert part.extent == pytest.approx((0.1, 0.05, 0.03), abs=1e-6)
    found = sorted((round(1000 * x), round(1000 * y), round(1000 * z)) for x, y, z in part.vertices)
    assert found == sorted(corners)


def test_a_part_looks_as_it_is_given_and_otherwise_as_its_colour() -> None:
    cell = Cell(1, scene=Scene(parts=(Box(colour="blue"), Box(name="carton", rgba=(0.7, 0.5, 0.3, 1)))))
    assert cell.simulation.model.geom("carton").rgba == pytest.approx((0.7, 0.5, 0.3, 1))
    red, _, blue, _ = cell.simulation.model.geom("box").rgba
    assert blue > red


def test_the_camera_sees_cylinders_and_meshes() -> None:
    for part in (Cylinder(), Mesh(vertices=HEXAGON)):
        cell = Cell(1, noise=False, scene=Scene(parts=(part,)))
        assert cell.sensors.box_position() == cell.truth.box_position()


@pytest.mark.parametrize(
    "part", [Box(size=(0.05, 0.08, 0.04)), Cylinder(), Mesh(vertices=HEXAGON, angles=(0.0, 0.0, 30.0))]
)
def test_the_fingers_hold_boxes_cylinders_and_meshes_by_friction(part: Part) -> None:
    cell = Cell(1, scene=Scene(parts=(part,)))
    place = cell.truth.box_position()
    cell.arm.move_joints((0.0, 26.0, 180.0, -78.0, 0.0, -76.0, 90.0))
    pose = cell.arm.commanded_pose()
    cell.arm.move_by(x=place.x - pose.x, y=place.y - pose.y)
    cell.arm.move_by(z=place.z + 0.025 - 0.9 - pose.z)
    cell.gripper.command(1, wait=True)
    cell.arm.move_by(z=0.1)
    cell.wait(1.0)
    assert cell.gripper.holding()
    assert cell.truth.box_position().z == pytest.approx(1.1, abs=0.002)
    assert cell.truth.box_tilt() < 1


RAMP = Fixture("ramp", (0.4, 0.4, 0.04), (0.55, 0.2, 1.1), friction=0.3, angles=(0.0, 20.0, 0.0))


def test_a_fixture_stands_as_steep_as_it_is_turned() -> None:
    """A box slides down it as Coulomb says; 20 degrees are steeper than a friction of 0.3 holds."""
    slope = math.radians(20)
    away, lowest = 0.02 + 0.025, 0.025 * (math.sin(slope) + math.cos(slope))
    place = (0.55 + away * math.sin(slope), 0.2, 1.1 + away * math.cos(slope) - lowest)
    box = Box(position=place, angles=(0.0, 20.0, 0.0), jitter=0.0)
    cell = Cell(1, scene=Scene(fixtures=(CONVEYOR, RAMP), parts=(box,)))
    start = cell.simulation.data.body("box").xpos.copy()
    cell.wait(0.3)
    moved = float(np.linalg.norm(cell.simulation.data.body("box").xpos - start))
    assert moved == pytest.approx((math.sin(slope) - 0.3 * math.cos(slope)) * GRAVITY * 0.3**2 / 2, rel=0.1)
    assert cell.truth.box_tilt() < 1


@pytest.mark.parametrize("height", [-0.02, 0.05])
def test_a_part_rests_on_a_fixture_where_that_has_been_moved_to(height: float) -> None:
    cell = on_table(Box(position=ON_TABLE))
    cell.wait(0.2)
    x, y, z = TARGET_TABLE.centre
    move_fixture(cell.simulation, "target table", (x, y, z + height), carried=["box"] if height > 0 else [])
    cell.wait(1.0)
    assert cell.truth.box_position().z == pytest.approx(0.76 + height, abs=1e-4)


def test_what_stands_on_a_fixture_turns_with_it_where_that_is_said() -> None:
    cell = on_table(Box(position=ON_TABLE, jitter=0.0))
    move_fixture(cell.simulation, "target table", TARGET_TABLE.centre, (0.0, 0.0, 90.0), carried=["box"])
    place = cell.truth.box_position()
    assert (place.x, place.y, place.z) == pytest.approx((-0.6 - 0.3, 0.0, 0.76), abs=1e-9)


@pytest.mark.parametrize(
    ("fixture", "carried"), [("tables", []), ("box", []), ("target table", ["conveyor"])]
)
def test_only_fixtures_are_moved_and_only_parts_carried(fixture: str, carried: list[str]) -> None:
    cell = on_table(Box(position=ON_TABLE))
    with pytest.raises(BadArgument, match="Expected the name of a"):
        move_fixture(cell.simulation, fixture, (0, 0, 0), carried=carried)
