import mission
from robot import Arm, Joint


def test_pick_runs():
    mission.pick(Arm())


def test_lift_joint():
    assert Joint.LIFT.at == 0.15


def test_turn_joint():
    assert Joint.TURN.at > 0
