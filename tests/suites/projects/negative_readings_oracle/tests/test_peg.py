import mission
import pytest
from checks import is_inserted, is_straight, peg_moved
from robot import Arm


@pytest.fixture
def arm():
    return Arm()


def test_deep(arm):
    mission.insert_peg(arm, 6.0)
    assert is_inserted(arm)
    assert is_straight(arm)


def test_shallow(arm):
    mission.insert_peg(arm, 1.0)
    assert peg_moved(arm)
