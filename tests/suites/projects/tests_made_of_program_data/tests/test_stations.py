import mission
import pytest

REACHED = int(mission.STATIONS[1][1])


def test_visit(station):
    assert mission.visit(station) >= 0.5


@pytest.mark.parametrize("number", range(REACHED))
def test_each(number):
    assert number < 3
