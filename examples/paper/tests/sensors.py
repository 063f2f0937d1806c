"""What the test reads to judge the program: one function per occasion."""

from __future__ import annotations

import tracker

from mutabot_cell import Position


def robot_home_position() -> Position:
    """Where the robot is before the program starts; base frame, m."""
    return tracker.robot_position()


def box_start_position() -> Position:
    """Where the box is before the program starts; world frame, m."""
    return tracker.box_position()


def box_end_position() -> Position:
    """Where the box is after the program; world frame, m."""
    return tracker.box_position()
