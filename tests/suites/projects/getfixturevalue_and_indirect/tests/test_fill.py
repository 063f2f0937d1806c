import mission
import pytest
from robot import Doser


@pytest.fixture(scope="module")
def water():
    doser = Doser()
    mission.fill(doser, 4.0)
    return doser


@pytest.fixture(scope="module")
def honey():
    doser = Doser(viscous=True)
    mission.fill(doser, 4.0)
    return doser


@pytest.fixture(scope="module")
def doser(request):
    return request.getfixturevalue(request.param)


@pytest.mark.parametrize("doser", ["water", "honey"], indirect=True)
def test_plunger_is_back(doser):
    assert doser.at == 0.0


@pytest.mark.parametrize("name, amount", [("water", 4.0), ("honey", 2.0)])
def test_amount(request, name, amount):
    assert request.getfixturevalue(name).out == amount


def test_valve_is_shut(request):
    assert not request.getfixturevalue("honey").open
