"""Where the base is, and how its wheels turn."""

import math

import pytest
from robot import Clock, Motor

from program import Drive

TURN = int(2048 * 9.5)


def made():
    return Drive(Motor(), Motor(), Clock())


def test_a_turn_of_the_wheels():
    drive = made()
    drive.left.ticks = drive.right.ticks = TURN
    drive.update()
    assert drive.pose() == pytest.approx((2 * math.pi * 0.08, 0.0, 0.0))


def test_it_turns_to_the_left():
    drive = made()
    drive.right.ticks = TURN
    drive.update()
    assert drive.heading == pytest.approx(2 * math.pi * 0.08 / 0.5)


def test_ticks_are_counted_once():
    drive = made()
    drive.left.ticks = drive.right.ticks = TURN
    drive.update()
    drive.update()
    assert drive.pose()[0] == pytest.approx(2 * math.pi * 0.08)


def test_both_motors_turn_against_each_other_to_go_ahead():
    drive = made()
    drive.command(0.5, 0.0)
    assert drive.left.log[0] == -drive.right.log[0] > 0


def test_it_stops():
    drive = made()
    drive.command(0.5, 0.0)
    drive.stop()
    assert drive.left.log[-1] == drive.right.log[-1] == 0.0


def test_reset():
    drive = made()
    drive.left.ticks = drive.right.ticks = TURN
    drive.update()
    drive.reset()
    assert drive.pose() == (0.0, 0.0, 0.0)


def test_creeping_ends():
    drive = made()
    drive.creep(0.1)
    assert drive.left.log[-1] == 0.0
