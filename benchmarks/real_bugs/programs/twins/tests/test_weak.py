"""Both arms do something."""

from robot import Arm, Panel

from program import Twins


def made(**more):
    return Twins(Arm(**more), Arm(**more), Panel())


def test_they_start():
    twins = made()
    twins.start()
    assert twins.left.enabled
    assert twins.right.enabled


def test_they_grip():
    assert made().grip()


def test_they_follow():
    twins = made()
    twins.follow()
    assert twins.path()


def test_they_lift():
    twins = made()
    twins.grip()
    assert twins.lift(0.1)
