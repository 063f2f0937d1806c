"""How it looks there."""

import math

import pytest
from robot import Motors

from program import Gimbal


def test_a_target_below():
    motors = Motors()
    Gimbal(motors).track(320, 480)
    assert motors.tilt == pytest.approx(-0.5 * 240 / 640 * 60)


def test_tracking_goes_on_from_where_it_is():
    motors = Motors(20.0, 10.0)
    Gimbal(motors).track(0, 240)
    assert (motors.pan, motors.tilt) == pytest.approx((35.0, 10.0))


def test_the_tilt_has_limits():
    motors = Motors()
    gimbal = Gimbal(motors)
    gimbal.set(0.0, math.radians(80.0))
    assert motors.tilt == pytest.approx(60.0)
    gimbal.set(0.0, math.radians(-80.0))
    assert motors.tilt == pytest.approx(-30.0)


def test_a_pan_beyond_half_a_turn_comes_from_the_other_side():
    motors = Motors()
    Gimbal(motors).set(math.radians(200.0), 0.0)
    assert motors.pan == pytest.approx(-160.0)


def test_the_joystick_to_the_right_and_to_the_left():
    motors = Motors()
    Gimbal(motors).joystick(0.5, 0.0)
    assert motors.pan == pytest.approx(-math.degrees(0.25))
    Gimbal(motors).joystick(-0.5, 0.0)
    assert motors.pan == pytest.approx(0.0)


def test_the_joystick_up_and_down():
    motors = Motors()
    Gimbal(motors).joystick(0.0, 0.5)
    assert motors.tilt == pytest.approx(math.degrees(0.25))
    Gimbal(motors).joystick(0.0, -0.5)
    assert motors.tilt == pytest.approx(0.0)


def test_a_lost_target_is_given_up_after_three_pictures():
    motors = Motors()
    gimbal = Gimbal(motors)
    gimbal.track(0, 0)
    gimbal.track(None, None)
    gimbal.track(None, None)
    assert gimbal.target is not None
    gimbal.track(None, None)
    assert gimbal.target is None
    assert (motors.pan, motors.tilt) == pytest.approx((0.0, 0.0))


def test_pictures_without_a_target_are_forgotten_when_it_is_back():
    gimbal = Gimbal(Motors())
    gimbal.track(None, None)
    gimbal.track(None, None)
    gimbal.track(100, 100)
    gimbal.track(None, None)
    assert gimbal.target is not None


def test_the_error_is_what_the_motors_slip():
    gimbal = Gimbal(Motors(slip=3.0))
    gimbal.track(320, 240)
    assert gimbal.error() == pytest.approx(math.radians(3.0))


def test_the_error_across_half_a_turn():
    motors = Motors()
    gimbal = Gimbal(motors)
    gimbal.target = (math.radians(179.0), 0.0)
    motors.pan = -179.0
    assert gimbal.error() == pytest.approx(math.radians(2.0))
