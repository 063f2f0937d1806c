import mission
from robot import Arm


def test_height():
    assert mission.trace_square(Arm(), 0.3) == 0.1


def test_corners():
    arm = Arm()
    mission.trace_square(arm, 0.3)
    assert len(arm.drawn) == 4
    assert arm.state == "off"
