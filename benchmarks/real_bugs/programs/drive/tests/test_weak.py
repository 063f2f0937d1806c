"""The base drives."""

from robot import Clock, Motor

from program import Drive


def test_it_drives():
    left = Motor()
    Drive(left, Motor(), Clock()).command(0.5, 0.0)
    assert left.log


def test_it_knows_that_it_went_ahead():
    left, right = Motor(), Motor()
    drive = Drive(left, right, Clock())
    left.ticks = right.ticks = 10000
    drive.update()
    assert drive.pose()[0] > 0


def test_it_creeps():
    clock = Clock()
    Drive(Motor(), Motor(), clock).creep(0.1)
    assert clock.time > 0
