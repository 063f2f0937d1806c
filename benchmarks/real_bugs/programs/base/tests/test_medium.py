"""The base moves as it is told."""

import pytest
from robot import Base

from program import Driver


def test_forward_is_forward():
    base = Base()
    Driver(base).joystick(0.0, 0.5)
    assert base.speeds == (0.25, 0.0, 0.0)


def test_right_is_right():
    base = Base()
    Driver(base).joystick(0.5, 0.0)
    assert base.speeds[1] == -0.25


def test_it_turns_to_the_goal_and_stops():
    base = Base()
    Driver(base).turn_to(-1.0)
    assert base.heading == pytest.approx(-1.0, abs=0.01)
    assert base.speeds == (0.0, 0.0, 0.0)


def test_a_goal_ahead():
    assert Driver(Base(1.0, 2.0)).goal_from(1.0, 0.0) == (2.0, 2.0)
