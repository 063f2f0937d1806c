import mission
from robot import Arm, total


def test_pick_runs():
    mission.pick(Arm())


def test_total_lift():
    assert total("lift") == 0.15


def test_total_turn():
    assert total("turn") <= 30.0
