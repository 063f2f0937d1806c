import mission
from robot import Arm, HEIGHT


def test_pick_runs():
    mission.pick(Arm())


def test_height():
    assert HEIGHT.get() == 0.15
