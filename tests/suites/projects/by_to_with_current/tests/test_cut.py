import mission
import pytest
from robot import Saw


@pytest.fixture
def saw():
    saw = Saw()
    mission.cut(saw)
    return saw


def test_far_enough(saw):
    assert saw.farthest >= 20.0


def test_comes_back(saw):
    assert saw.x == pytest.approx(0.0, abs=11)


def test_angle():
    saw = Saw()
    mission.cut(saw)
    assert saw.angle == 90
