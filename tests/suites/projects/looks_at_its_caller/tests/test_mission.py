import mission
import pytest
from robot import Arm


@pytest.fixture
def arm():
    return Arm()


def test_comes_home(arm):
    mission.tour(arm, 0.5)
    assert arm.x == 0


def test_is_called_by_the_tour(arm):
    mission.tour(arm, 0.5)
    assert arm.log == [("tour", "mission", 2, 1), ("tour", "mission", 4, 3)]


def test_warns_of_a_long_way(arm):
    with pytest.raises(UserWarning, match="a long way"):
        mission.tour(arm, 2.0)


def test_goes_near(arm):
    assert mission.tour(arm, 0.5) > -2
