"""Backwards, round the back, and no faster than allowed."""

import math

import pytest
from robot import Base

from program import MOST, Driver


def test_backward_is_backward():
    base = Base()
    Driver(base).joystick(0.0, -0.5)
    assert base.speeds[0] == -0.25


def test_it_takes_the_short_way_round_the_back():
    base = Base(heading=3.0)
    Driver(base).turn_to(-3.0)
    assert base.heading == pytest.approx(2.0 * math.pi - 3.0, abs=0.01)


def test_no_faster_than_allowed():
    base = Base()
    Driver(base).joystick(0.0, 1.0)
    assert base.speeds[0] == MOST


def test_a_small_push_is_none():
    base = Base()
    Driver(base).joystick(0.04, 0.04)
    assert base.speeds == (0.0, 0.0, 0.0)


def test_a_goal_to_the_left_of_a_turned_base():
    x, y = Driver(Base(heading=math.pi / 2)).goal_from(2.0, 1.0)
    assert (x, y) == pytest.approx((-1.0, 2.0))


def test_what_was_seen_before_a_turn():
    assert Driver(Base(heading=0.5)).heading_of(0.25, 0.125) == pytest.approx(0.625)
