import mission
import pytest
from robot import Rover


@pytest.mark.parametrize("legs, travelled", [([1.0, 2.0], 3.0), ([4.0], 4.0), ([], 0.0)])
def test_travelled(legs, travelled):
    assert mission.survey(Rover(), legs)["travelled"] == travelled


def test_battery():
    assert mission.survey(Rover(), [2.0, -2.0])["battery"] == 80.0
