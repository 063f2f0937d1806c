from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from mutabot_cell import BadArgument, Box, Cell, Scene
from mutabot_cell.models import robotiq


def test_fingers_close_at_their_speed() -> None:
    cell = Cell(seed=1, finger_speed=0.05)
    cell.gripper.command(1)
    cell.wait(1.0)
    assert cell.truth.opening() == pytest.approx(robotiq.STROKE - 0.05, abs=0.002)
    cell.wait(1.0)
    assert cell.truth.opening() == pytest.approx(0.0, abs=0.001)


def test_command_returns_at_once_and_half_closes() -> None:
    cell = Cell(seed=1)
    cell.gripper.command(0.5)
    assert cell.time == 0.0
    cell.wait(1.0)
    assert cell.truth.opening() == pytest.approx(robotiq.STROKE / 2, abs=0.001)
    assert cell.gripper.commanded() == 0.5
    assert not cell.gripper.holding()


def test_fingers_stay_coupled(cell: Cell, grip: Callable[[Cell], None]) -> None:
    grip(cell)
    left, right = cell.simulation.data.qpos[7:9]
    assert left == pytest.approx(right, abs=0.0005)


def test_gripped_box_is_lifted_by_friction_and_reported_as_held(
    cell: Cell, grip: Callable[[Cell], None]
) -> None:
    grip(cell)
    assert cell.gripper.holding()
    assert cell.gripper.opening() == pytest.approx(0.05, abs=0.002)
    cell.arm.move_by(z=0.2)
    assert cell.truth.box_position().z == pytest.approx(1.2, abs=0.005)
    assert cell.simulation.model.neq == 1, "nothing but the fingers' coupling ties bodies together"


def test_closed_on_nothing_is_not_holding(cell: Cell) -> None:
    cell.gripper.command(1, wait=True)
    assert not cell.gripper.holding()
    assert cell.gripper.opening() == pytest.approx(0.0, abs=0.002)


def test_box_without_friction_slips_out(slippery_scene: Scene, grip: Callable[[Cell], None]) -> None:
    cell = Cell(seed=1, scene=slippery_scene)
    grip(cell)
    cell.arm.move_by(z=0.2)
    assert cell.truth.box_position().z < 1.05


def test_heavy_box_slips_with_a_weak_grip_and_holds_with_a_strong_one(grip: Callable[[Cell], None]) -> None:
    heavy = Scene(parts=(Box(mass=0.6, friction=0.1),))
    heights = []
    for force in robotiq.FORCE_RANGE:
        cell = Cell(seed=1, scene=heavy, grip_force=force)
        grip(cell)
        cell.arm.move_by(z=0.15)
        heights.append(cell.truth.box_position().z)
    weak, strong = heights
    assert weak < 1.05
    assert strong > 1.1


def test_opened_fingers_drop_the_box(cell: Cell, grip: Callable[[Cell], None]) -> None:
    grip(cell)
    cell.arm.move_by(z=0.05)
    cell.gripper.command(0)
    cell.wait(1.0)
    assert cell.truth.box_position().z == pytest.approx(1.0, abs=0.002)
    assert not cell.gripper.holding()


@pytest.mark.parametrize("position", [-0.1, 1.1, math.nan, "open", None, True])
def test_position_outside_its_range_is_refused(cell: Cell, position: object) -> None:
    with pytest.raises(BadArgument, match="position"):
        cell.gripper.command(position)  # type: ignore[arg-type]


def test_force_and_speed_outside_the_data_sheet_are_refused(cell: Cell) -> None:
    with pytest.raises(BadArgument, match="force"):
        cell.gripper.set_force(10)
    with pytest.raises(BadArgument, match="speed"):
        cell.gripper.set_speed(0.2)
