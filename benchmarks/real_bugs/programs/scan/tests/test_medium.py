"""Where it sees things."""

import math

import pytest
from robot import Base, Laser, Pose

from program import Scanner, quaternion_of, yaw_of


def made(*ranges, pose=None, **more):
    return Scanner(Laser(*ranges, **more), pose or Pose(), Base())


def test_straight_ahead_of_the_scanner():
    (point,) = made(2.0, first=-0.15).read()
    assert point == pytest.approx((2.2, 0.0))


def test_ranges_out_of_range_are_left_out():
    assert made(0.05, 9.0, math.inf, math.nan).read() == []


def test_a_robot_elsewhere():
    scanner = made(pose=Pose((1.0, 2.0, 0.0)))
    assert scanner.in_map((0.5, 0.25)) == pytest.approx((1.5, 2.25))


def test_a_turned_robot():
    scanner = made(pose=Pose(orientation=quaternion_of(math.pi / 2)))
    assert scanner.in_map((1.0, 0.0)) == pytest.approx((0.0, 1.0))


def test_what_is_ahead():
    assert made(2.0, 1.0, first=-0.15, step=0.05).ahead() == pytest.approx(0.2 + math.cos(0.05))


def test_near_it_stops():
    scanner = made(0.3, first=-0.15)
    assert scanner.guard(0) == "stop"
    assert scanner.base.log == ["stop"]


def test_in_between_it_slows():
    scanner = made(1.0, first=-0.15)
    assert scanner.guard(0) == "slow"
    assert scanner.base.log == [("limit", 0.2)]


def test_yaw_there_and_back():
    assert yaw_of(quaternion_of(0.7)) == pytest.approx(0.7)


def test_it_faces_a_point():
    scanner = made()
    scanner.face((1.0, 1.0))
    assert scanner.base.log == [("turn", pytest.approx(45.0))]
