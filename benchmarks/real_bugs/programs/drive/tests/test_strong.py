"""How the base drives."""

import math

import pytest
from robot import Clock, Motor

from program import FASTEST, Drive

TURN = int(2048 * 9.5)
ROUND = 2 * math.pi * 0.08


def made(left=0, right=0):
    return Drive(Motor(left), Motor(right), Clock())


def test_ticks_before_the_start_count_for_nothing():
    drive = made(500, 900)
    drive.update()
    assert drive.pose() == (0.0, 0.0, 0.0)


def test_half_of_a_turn_is_driven_at_half_of_the_angle():
    drive = made()
    drive.right.ticks = TURN
    drive.update()
    turn = ROUND / 0.5
    assert drive.pose()[:2] == pytest.approx((ROUND / 2 * math.cos(turn / 2), ROUND / 2 * math.sin(turn / 2)))


def test_the_heading_is_folded():
    drive = made()
    drive.right.ticks = 4 * TURN
    drive.update()
    assert drive.heading == pytest.approx(4 * ROUND / 0.5 - 2 * math.pi)


def test_turns_per_minute():
    drive = made()
    drive.command(ROUND, 0.0)
    assert drive.left.log == pytest.approx([570.0])


def test_turning_to_the_left_the_right_wheel_is_faster():
    drive = made()
    drive.command(0.5, 1.0)
    assert drive.left.log[0] == pytest.approx(drive.turns(0.25))
    assert drive.right.log[0] == pytest.approx(-drive.turns(0.75))


def test_too_fast_is_slowed_and_keeps_its_curve():
    drive = made()
    drive.command(2.0, 1.6)
    assert drive.right.log[0] == pytest.approx(-drive.turns(FASTEST))
    assert drive.left.log[0] == pytest.approx(drive.turns(FASTEST * 1.6 / 2.4))


def test_without_new_commands_it_stops():
    drive = made()
    drive.command(0.5, 0.0)
    drive.clock.sleep(0.4)
    drive.watch()
    assert drive.left.log[-1] != 0.0
    drive.clock.sleep(0.2)
    drive.watch()
    assert drive.left.log[-1] == drive.right.log[-1] == 0.0


def test_it_stops_once():
    drive = made()
    drive.command(0.5, 0.0)
    drive.clock.sleep(0.6)
    drive.watch()
    drive.watch()
    assert len(drive.left.log) == 2


def test_creeping_is_slow_and_as_long_as_it_takes():
    drive = made()
    drive.creep(0.1)
    assert drive.left.log == pytest.approx([drive.turns(0.2), 0.0])
    assert drive.clock.time == pytest.approx(0.5)


def test_creeping_back():
    drive = made()
    drive.creep(-0.1)
    assert drive.left.log[0] == pytest.approx(-drive.turns(0.2))


def test_after_creeping_it_is_as_fast_as_before():
    drive = made()
    drive.creep(0.1)
    drive.command(1.0, 0.0)
    assert drive.left.log[-1] == pytest.approx(drive.turns(1.0))


def test_after_a_reset_old_ticks_count_for_nothing():
    drive = made()
    drive.left.ticks = drive.right.ticks = TURN
    drive.reset()
    drive.update()
    assert drive.pose() == (0.0, 0.0, 0.0)
