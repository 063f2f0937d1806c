import mission
from robot import Arm, steps


def test_pick_runs():
    mission.pick(Arm())


def test_steps():
    assert sum(steps()) > 29.0


def test_no_step_down_first():
    assert steps()[0] > 0
