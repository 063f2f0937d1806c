"""The gimbal moves."""

from robot import Motors

from program import Gimbal


def test_it_points():
    motors = Motors()
    Gimbal(motors).point_at(1.0, 1.0, 0.5)
    assert motors.pan > 0
    assert motors.tilt > 0


def test_it_tracks():
    motors = Motors()
    Gimbal(motors).track(100, 100)
    assert motors.log


def test_it_follows_the_joystick():
    motors = Motors()
    Gimbal(motors).joystick(0.5, 0.5)
    assert motors.pan != 0


def test_it_settles():
    assert Gimbal(Motors()).settled()
