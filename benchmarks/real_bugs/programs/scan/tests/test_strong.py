"""How it sees them."""

import math

import pytest
from robot import Base, Laser, Pose

from program import Scanner, quaternion_of, yaw_of


def made(*ranges, pose=None, **more):
    return Scanner(Laser(*ranges, **more), pose or Pose(), Base())


def test_the_angle_goes_with_the_index():
    one, other = made(1.0, 9.0, 1.0, first=-0.15, step=0.25).read()
    assert one == pytest.approx((1.2, 0.0))
    assert other == pytest.approx((0.2 + math.cos(0.5), math.sin(0.5)))


def test_a_turned_robot_elsewhere():
    scanner = made(pose=Pose((1.0, 2.0, 0.0), quaternion_of(math.pi / 2)))
    assert scanner.in_map((1.0, 0.5)) == pytest.approx((0.5, 3.0))


def test_to_the_map_and_back():
    scanner = made(pose=Pose((1.0, 2.0, 0.0), quaternion_of(0.4)))
    assert scanner.in_base(scanner.in_map((0.3, -0.2))) == pytest.approx((0.3, -0.2))


def test_a_turned_robot_faces_a_point():
    scanner = made(pose=Pose((1.0, 1.0, 0.0), quaternion_of(math.pi / 2)))
    scanner.face((2.0, 1.0))
    assert scanner.base.log == [("turn", pytest.approx(-90.0))]


def test_things_beside_the_way_are_not_in_it():
    assert made(1.0, first=0.5).ahead() is None


def test_an_old_scan_is_a_reason_to_stop():
    scanner = made(stamp=1.0)
    assert scanner.guard(1200) == "go"
    assert scanner.guard(1400) == "stop"


def test_it_slows_once():
    scanner = made(1.0, first=-0.15)
    scanner.guard(0)
    scanner.guard(0)
    assert scanner.base.log == [("limit", 0.2)]


def test_when_the_way_is_clear_it_is_fast_again():
    scanner = made(1.0, first=-0.15)
    scanner.guard(0)
    scanner.laser.scan.ranges = [5.0]
    assert scanner.guard(0) == "go"
    assert scanner.base.log[1:] == [("limit", 1.0)]
    assert not scanner.slowed


def test_points_are_gathered_on_the_map():
    scanner = made(2.0, first=-0.15, pose=Pose((1.0, 0.0, 0.0)))
    scanner.add()
    scanner.add()
    assert scanner.points == [pytest.approx((3.2, 0.0))] * 2


def test_cleared_points_are_handed_out():
    scanner = made(2.0)
    scanner.add()
    assert len(scanner.clear()) == 1
    assert scanner.points == []


def test_the_scalar_part_comes_first():
    assert yaw_of((math.cos(0.25), 0.0, 0.0, math.sin(0.25))) == pytest.approx(0.5)
    assert yaw_of((0.5, 0.5, 0.5, 0.5)) == pytest.approx(math.pi / 2)


def test_the_farthest_range_counts():
    assert len(made(8.0, 0.1).read()) == 2
