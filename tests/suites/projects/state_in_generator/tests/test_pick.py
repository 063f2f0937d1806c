import mission
from robot import Arm, height


def test_pick_runs():
    mission.pick(Arm())


def test_height():
    assert height() == 0.15
