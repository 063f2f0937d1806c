import mission
import pytest
from robot import Station


@pytest.fixture
def station():
    station = Station()
    yield station
    assert not station.power


def test_the_cap_was_squeezed(station):
    mission.assemble(station)
    assert [grip.part for grip in station.grips if grip.tight] == ["cap"]


def test_pressed_deep_enough(station):
    mission.assemble(station)
    assert station.most >= 12.0
