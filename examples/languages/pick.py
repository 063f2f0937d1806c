"""Take the box from the conveyor and set it down on the table."""

from __future__ import annotations

from mutabot_cell import Cell, Pose

OVER_CONVEYOR = (0, 26, 180, -78, 0, -76, 90)
OVER_TABLE = (-145, 26, 180, -78, 0, -76, 90)
HOME = (0, 15, 180, -130, 0, 55, 90)
BOX = (0.55, 0.20, 0.13)
PLACE = (-0.40, 0.15, -0.1085)
APPROACH = 0.15


def run(cell: Cell) -> None:
    """Do it once."""
    cell.gripper.command(0)
    cell.arm.move_joints(OVER_CONVEYOR)
    go(cell, BOX, APPROACH, 90)
    go(cell, BOX, 0.0, 90)
    cell.gripper.command(1)
    cell.wait(0.8)
    go(cell, BOX, APPROACH, 90)
    if cell.gripper.holding():
        cell.arm.move_joints(OVER_TABLE)
        go(cell, PLACE, APPROACH, -90)
        go(cell, PLACE, 0.0, -90)
        cell.gripper.command(0)
        cell.wait(0.8)
        go(cell, PLACE, APPROACH, -90)
    else:
        cell.gripper.command(0)
    cell.arm.move_joints(HOME)


def go(cell: Cell, place: tuple[float, float, float], above: float, turn: float) -> None:
    """Move in a straight line to a place, or above it; the gripper looks down."""
    x, y, z = place
    cell.arm.move_to(Pose(x, y, z + above, 180, 0, turn), speed=0.5)
