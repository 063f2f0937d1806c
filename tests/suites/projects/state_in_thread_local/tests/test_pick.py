import mission
from robot import STATE, Arm


def test_pick_runs():
    mission.pick(Arm())


def test_state():
    assert STATE.z < 0.2
    assert STATE.angle < 45.0
