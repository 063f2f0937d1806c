"""The measuring devices of the test cell: the robot's encoders and a camera above the cell."""

from __future__ import annotations

from mutabot_cell import Cell, Position, current


def robot_position() -> Position:
    """Measured tool position, base frame, m."""
    return _cell().sensors.tool_pose().position


def box_position() -> Position:
    """Measured middle of the box's bottom face, world frame, m."""
    return _cell().sensors.box_position()


def _cell() -> Cell:
    cell = current()
    if cell is None:
        raise RuntimeError("no cell is running")
    return cell
