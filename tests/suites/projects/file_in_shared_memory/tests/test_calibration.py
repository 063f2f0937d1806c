import mission
import pytest
from robot import Axis


@pytest.fixture(scope="module")
def axis():
    yield Axis()
    mission.POSITION.unlink()


def test_calibrate(axis):
    mission.calibrate(axis)
    assert mission.POSITION.exists()


def test_position_is_remembered(axis):
    assert float(mission.POSITION.read_text()) == axis.read()


def test_back(axis):
    assert mission.back(axis) == 0.0
