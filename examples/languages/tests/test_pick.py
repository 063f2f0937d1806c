"""Does the box end at its place, and does the arm go home without one, whatever the program is written in?"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from mutabot_cell import Box, Cell

CellWith = Callable[..., Cell]
Run = Callable[[Cell], None]

TABLE_TOP = 0.76
PLACE = (-0.40, 0.15)
PLACED_WITHIN = 0.0035
"""The feeder's placement, at most 1 mm, and how the fingers centre the box."""
HOME = (0.5767, 0.0014, 0.4337)
HOME_WITHIN = 0.0015
CYCLE_TIME = 15.6
"""From home to home with a box, s: what the program needs, rounded up."""
LOOSE, LOW = 0.052, 0.006
"""Fingers further apart than this do not hold the box; from this height it may be let go, m."""


def test_the_box_is_set_down_at_its_place(cell_with: CellWith, run: Run) -> None:
    cell = cell_with(Box(colour="red"))
    cell.always(lambda: is_held(cell) or height(cell) < LOW, "the box is never dropped")
    cell.always(lambda: height(cell) > -0.002, "the box is not pressed into anything")

    run(cell)

    box = cell.truth.box_position()
    assert (box.x, box.y) == pytest.approx(PLACE, abs=PLACED_WITHIN)
    assert box.z == pytest.approx(TABLE_TOP, abs=0.002)
    check_home(cell)
    assert cell.time < CYCLE_TIME


def test_without_a_box_the_arm_goes_home(cell_with: CellWith, run: Run) -> None:
    cell = cell_with()

    run(cell)

    check_home(cell)
    assert cell.time < CYCLE_TIME / 2 + 1.5


def check_home(cell: Cell) -> None:
    """The arm stands at home, the gripper opens."""
    pose = cell.truth.tool_pose()
    assert (pose.x, pose.y, pose.z) == pytest.approx(HOME, abs=HOME_WITHIN)
    assert cell.gripper.commanded() == 0


def is_held(cell: Cell) -> bool:
    """Whether the fingers are near enough to hold a box."""
    return cell.truth.opening() < LOOSE


def height(cell: Cell) -> float:
    """Of the box above the conveyor or the table, whichever is below it; 0 between them, m."""
    box = cell.truth.box_position()
    return box.z - (1.0 if box.x > 0.1 else TABLE_TOP if box.x < -0.2 else box.z)
