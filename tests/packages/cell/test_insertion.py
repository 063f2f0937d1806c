"""A peg goes into a fixture by force: what the cell brings is enough for an insertion."""

from __future__ import annotations

import pytest

from mutabot_cell import Box, Cell, Fixture, Scene
from mutabot_cell.scene import CONVEYOR, TARGET_TABLE

DOWN = (0, 26, 180, -78, 0, -76, 90)
PEG, LENGTH = 0.02, 0.08
"""Edge and length of the peg, m."""
GAP, DEPTH = 0.0008, 0.025
"""Clearance of the hole, both sides together, and its depth, m."""
HOLE = (0.5, 0.1)
BASE_HEIGHT, CONVEYOR_TOP = 0.9, 1.0


def block_with_hole(x: float, y: float) -> tuple[Fixture, ...]:
    """Four bars around a square hole over the conveyor."""
    half, bar, height = (PEG + GAP) / 2, 0.04, CONVEYOR_TOP + DEPTH / 2
    long = 2 * half + 2 * bar
    return (
        Fixture("bar +x", (bar, long, DEPTH), (x + half + bar / 2, y, height)),
        Fixture("bar -x", (bar, long, DEPTH), (x - half - bar / 2, y, height)),
        Fixture("bar +y", (2 * half, bar, DEPTH), (x, y + half + bar / 2, height)),
        Fixture("bar -y", (2 * half, bar, DEPTH), (x, y - half - bar / 2, height)),
    )


def grip_peg(cell: Cell) -> None:
    """Take the upright peg at its upper end."""
    peg = cell.truth.box_position("peg")
    cell.arm.move_joints(DOWN)
    pose = cell.arm.commanded_pose()
    cell.arm.move_by(x=peg.x - pose.x, y=peg.y - pose.y)
    cell.arm.move_by(z=peg.z + LENGTH - 0.02 - BASE_HEIGHT - pose.z)
    cell.gripper.set_force(120)
    cell.gripper.command(1, wait=True)
    cell.arm.move_by(z=0.1)


def insert(cell: Cell) -> int:
    """Feel for the hole around where it should be, then push the peg in; how often it felt, 0 if in vain."""
    arm, step = cell.arm, 0.0006
    pose, peg = arm.commanded_pose(), cell.truth.box_position("peg")
    arm.move_by(x=HOLE[0] - peg.x, y=HOLE[1] - peg.y)
    arm.move_by(z=CONVEYOR_TOP + DEPTH + 0.005 - peg.z)
    pose = arm.commanded_pose()
    cell.wait(0.3)
    cell.force_sensor.zero()
    spiral = sorted(
        ((i, j) for i in range(-3, 4) for j in range(-3, 4)), key=lambda place: place[0] ** 2 + place[1] ** 2
    )
    for tries, (i, j) in enumerate(spiral, 1):
        now = arm.commanded_pose()
        arm.move_by(x=pose.x + i * step - now.x, y=pose.y + j * step - now.y)
        if not arm.move_until_contact(z=-0.008, force=4.0, speed=0.02):  # 3 mm deep
            arm.push(x=0.0, y=0.0, z=-15.0, seconds=6.0, travel=0.05, speed=0.01)
            return tries
        arm.move_by(z=pose.z - arm.commanded_pose().z)
    return 0


@pytest.mark.parametrize("misplaced", [(0.0, 0.0), (0.0012, -0.0008), (-0.0015, 0.0013)], ids=str)
def test_a_peg_is_felt_into_a_hole_that_is_not_quite_where_it_should_be_and_pushed_to_its_ground(
    misplaced: tuple[float, float],
) -> None:
    peg = Box(name="peg", position=(0.5, -0.1, CONVEYOR_TOP), size=(PEG, PEG, LENGTH), mass=0.05, jitter=0.0)
    hole = block_with_hole(HOLE[0] + misplaced[0], HOLE[1] + misplaced[1])
    cell = Cell(1, scene=Scene(fixtures=(CONVEYOR, TARGET_TABLE, *hole), parts=(peg,)))
    grip_peg(cell)
    assert cell.gripper.holding()
    tries = insert(cell)
    assert tries == 1 if misplaced == (0.0, 0.0) else tries > 1
    place = cell.truth.box_position("peg")
    assert place.z == pytest.approx(CONVEYOR_TOP, abs=0.0005), "on the ground of the hole"
    assert place.x == pytest.approx(HOLE[0] + misplaced[0], abs=GAP)
    assert place.y == pytest.approx(HOLE[1] + misplaced[1], abs=GAP)
    assert cell.truth.box_tilt("peg") < 2.0
    cell.gripper.command(0, wait=True)
    cell.arm.move_by(z=0.1)
    assert cell.truth.box_position("peg").z == pytest.approx(CONVEYOR_TOP, abs=0.0005), "it stays there"


def test_a_peg_beside_the_hole_stays_out_of_it() -> None:
    peg = Box(name="peg", position=(0.5, -0.1, CONVEYOR_TOP), size=(PEG, PEG, LENGTH), mass=0.05, jitter=0.0)
    hole = block_with_hole(HOLE[0] + 0.015, HOLE[1])
    cell = Cell(1, scene=Scene(fixtures=(CONVEYOR, TARGET_TABLE, *hole), parts=(peg,)))
    grip_peg(cell)
    assert insert(cell) == 0
    assert cell.truth.box_position("peg").z > CONVEYOR_TOP + DEPTH - 0.001
