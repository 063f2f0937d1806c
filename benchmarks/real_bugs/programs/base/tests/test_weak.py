"""The base moves."""

from robot import Base

from program import Driver


def test_the_joystick_moves_it():
    base = Base()
    Driver(base).joystick(0.0, 1.0)
    assert base.speeds != (0.0, 0.0, 0.0)


def test_it_turns():
    base = Base()
    Driver(base).turn_to(1.0)
    assert base.heading > 0.5
