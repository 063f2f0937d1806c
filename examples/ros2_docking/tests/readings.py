"""What the tests read to judge the program by."""

from __future__ import annotations

from station import Station


def gap(station: Station) -> float:
    """How far the robot is from its place on the dock, in m."""
    return station.gap


def top_speed(station: Station, within: float = 10.0) -> float:
    """How fast the robot has been at most, so near to the dock; in m/s."""
    return max((abs(speed) for distance, speed in station.robot.driven if distance < within), default=0.0)


def is_charging(station: Station) -> bool:
    """Whether the contacts are closed."""
    return station.charging
