"""Where it looks."""

import math

import pytest
from robot import Motors

from program import Gimbal


def pointed(*place):
    motors = Motors()
    Gimbal(motors).point_at(*place)
    return motors.pan, motors.tilt


def test_ahead():
    assert pointed(1.0, 0.0, 0.0) == pytest.approx((0.0, 0.0))


def test_to_the_left():
    assert pointed(1.0, 1.0, 0.0) == pytest.approx((45.0, 0.0))


def test_up():
    assert pointed(1.0, 0.0, 1.0) == pytest.approx((0.0, 45.0))


def test_not_behind():
    assert abs(pointed(-1.0, 0.0, 0.0)[0]) == pytest.approx(170.0)


def test_a_target_in_the_middle_needs_no_move():
    motors = Motors(10.0, 5.0)
    Gimbal(motors).track(320, 240)
    assert (motors.pan, motors.tilt) == pytest.approx((10.0, 5.0))


def test_a_target_at_the_right():
    motors = Motors()
    Gimbal(motors).track(640, 240)
    assert motors.pan == pytest.approx(-15.0)


def test_there_is_no_error_without_a_target():
    assert Gimbal(Motors()).error() is None


def test_a_small_push_is_none():
    motors = Motors(10.0, 5.0)
    Gimbal(motors).joystick(0.04, -0.04)
    assert (motors.pan, motors.tilt) == pytest.approx((10.0, 5.0))


def test_it_is_not_settled_while_it_moves():
    motors = Motors()
    motors.moving = True
    assert not Gimbal(motors).settled()


def test_wrapped_is_between():
    from program import wrapped

    assert wrapped(1.5 * math.pi) == pytest.approx(-0.5 * math.pi)
