import mission
import pytest
from robot import Arm, OutOfReach


def test_too_far_is_refused():
    with pytest.raises(OutOfReach):
        mission.reach(Arm(), 5.0)


def test_it_is_said_what_was_too_far():
    with pytest.raises(OutOfReach, match=r"^4\.0 m"):
        mission.reach(Arm(), 4.0)


def test_the_first_that_can_be_reached():
    arm = Arm()
    assert mission.reach_first(arm, [3.0, 0.5]) == 0.5
    assert arm.notes == ["skipped"]


def test_back():
    arm = Arm()
    mission.face_back(arm)
    assert arm.yaw == 180.0


def test_side():
    arm = Arm()
    mission.face_side(arm)
    assert arm.yaw == 90.0


def test_the_rail_is_blocked():
    assert mission.slide(Arm()) == "blocked"
