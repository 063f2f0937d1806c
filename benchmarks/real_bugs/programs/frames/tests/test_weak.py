"""The arm moves."""

from robot import Arm, Sensors

from program import Grasper


def test_it_moves():
    arm = Arm()
    Grasper(arm, Sensors()).approach(0.0)
    assert arm.sent


def test_it_feels():
    assert Grasper(Arm(), Sensors(left=3.0, right=3.0)).has_part()
