"""Straight ahead."""

import pytest
from robot import Arm, Sensors

from program import Frame, Grasper


def test_a_part_straight_ahead():
    arm = Arm()
    Grasper(arm, Sensors()).approach(0.0)
    assert arm.pose == pytest.approx((0.43, 0.0, 0.0))


def test_a_nudge_ahead():
    arm = Arm((1.0, 2.0, 0.0))
    Grasper(arm, Sensors()).nudge(0.25, 0.0)
    assert arm.pose == pytest.approx((1.25, 2.0, 0.0))


def test_nothing_is_held_without_force():
    assert not Grasper(Arm(), Sensors()).has_part()


def test_part_of_the_way():
    arm = Arm((1.0, 1.0, 0.0))
    Grasper(arm, Sensors()).halfway(Frame(2.0, 3.0, 1.0))
    assert arm.pose == pytest.approx((1.25, 1.5, 0.25))
