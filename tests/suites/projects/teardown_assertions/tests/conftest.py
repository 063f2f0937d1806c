import pytest
from robot import Spindle


@pytest.fixture(scope="session")
def shop():
    spindles = []
    yield spindles
    assert all(spindle.rpm == 0 for spindle in spindles), "a spindle still turns at the end of the day"


@pytest.fixture(scope="module")
def shift(shop):
    first = len(shop)
    yield shop
    assert all(spindle.depth == 0 for spindle in shop[first:]), "a drill was left in a hole"
