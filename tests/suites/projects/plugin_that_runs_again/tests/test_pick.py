import mission
from robot import Arm

ARM = Arm()


def test_pick():
    mission.pick(ARM)
    assert ARM.z in (0.15, 0.45)


def test_angle():
    ARM.turn(5.0)
    assert ARM.angle > 7.0
