"""The program runs while the file is collected, and again in a test."""

import mission
from robot import Axis

AXES = [Axis(3), Axis(4)]
POSITIONS = mission.home_all(AXES)


def test_homed():
    assert all(axis.homed for axis in AXES)


def test_positions():
    assert POSITIONS == [1, 1]


def test_far_axis():
    axis = Axis(4)
    mission.home_all([axis])
    assert axis.position() >= 0
