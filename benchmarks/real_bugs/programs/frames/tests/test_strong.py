"""With the hand turned, and with one finger."""

import math

import pytest
from robot import Arm, Sensors

from program import Frame, Grasper


def test_a_part_beside_a_turned_hand():
    arm = Arm((1.0, 1.0, math.pi / 2))
    Grasper(arm, Sensors()).approach(math.pi / 2)
    assert arm.pose == pytest.approx((1.0 - 0.5 + 0.12, 1.05, math.pi))


def test_a_stand_off_is_this_side_of_the_part():
    arm = Arm()
    Grasper(arm, Sensors()).approach(0.0, stand_off=0.1)
    assert arm.pose[0] == pytest.approx(0.33)


def test_a_nudge_of_a_turned_hand():
    arm = Arm((0.0, 0.0, math.pi / 2))
    Grasper(arm, Sensors()).nudge(0.25, 0.5)
    assert arm.pose == pytest.approx((-0.5, 0.25, math.pi / 2))


def test_one_finger_is_not_enough():
    assert not Grasper(Arm(), Sensors(left=3.0)).has_part()
    assert not Grasper(Arm(), Sensors(right=3.0)).has_part()


def test_leaning_to_the_left_is_positive():
    assert Grasper(Arm(), Sensors(left=3.0, right=1.0)).leaning() == 2.0


def test_a_frame_and_its_inverse():
    frame = Frame(1.0, 2.0, 0.5)
    found = frame @ frame.inverse()
    assert (found.x, found.y, found.turn) == pytest.approx((0.0, 0.0, 0.0))
