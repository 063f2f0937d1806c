"""No test asks for the fixture that runs the program."""

from conftest import SPRAYER


def test_imports():
    assert SPRAYER is not None


def test_painted_length():
    assert abs(SPRAYER.painted - 0.4) < 1e-9


def test_valve_is_shut():
    assert not SPRAYER.painting
