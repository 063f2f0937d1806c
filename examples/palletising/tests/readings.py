"""What the tests read to judge by: one function per occasion."""

from __future__ import annotations

from mutabot_cell import Cell, Pose, Position


def tool_after(cell: Cell) -> Pose:
    """Where the arm stands after the program; base frame, m and degrees."""
    return cell.sensors.tool_pose()


def box_after(cell: Cell, name: str) -> Position:
    """Where a box lies after the program, as the camera sees it; world frame, m."""
    return cell.sensors.box_position(name)


def belt_speed_after(cell: Cell) -> float:
    """How fast the belt runs after the program, m/s."""
    return cell.belt().speed()


def belt_travel_after(cell: Cell) -> float:
    """How far the belt has run, m."""
    return cell.belt().position()


def vacuum_after(cell: Cell) -> float:
    """In the cup after the program, Pa below the atmosphere."""
    return cell.suction.vacuum()
