"""What the tests read to judge by: one function per occasion."""

from __future__ import annotations

from mutabot_cell import Cell, Pose, Position


def tool_at_rest(cell: Cell) -> Pose:
    """Where the arm stands before and after the program; base frame, m and degrees."""
    return cell.sensors.tool_pose()


def box_before(cell: Cell) -> Position:
    """Where the box lies before the program; world frame, m."""
    return cell.sensors.box_position()


def box_after(cell: Cell) -> Position:
    """Where the box lies after the program; world frame, m."""
    return cell.sensors.box_position()


def opening_after(cell: Cell) -> float:
    """How far the gripper is open after the program, m."""
    return cell.gripper.opening()
