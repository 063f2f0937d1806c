import mission
import pytest
from robot import Agv


@pytest.mark.parametrize("level", [10, 30, 70])
def test_plugged(level):
    agv = Agv(level)
    if not mission.charge(agv):
        pytest.skip("enough is left")
    assert agv.at > 0


def test_full_battery_stays():
    agv = Agv(90)
    assert not mission.charge(agv)
    assert agv.at == 0.0


@pytest.fixture
def plugged():
    agv = Agv(10)
    mission.charge(agv)
    if not agv.plugged:
        pytest.skip("not at the charger")
    return agv


def test_at_the_charger(plugged):
    assert plugged.at == 5.0


@pytest.mark.skip(reason="needs the real charger")
def test_current():
    mission.charge(Agv(10))
    raise AssertionError
