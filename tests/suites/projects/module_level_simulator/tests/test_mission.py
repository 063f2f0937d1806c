"""Written in order: each test goes on where the last one stopped."""

import mission
import robot


def test_prepare():
    mission.prepare()
    assert robot.STATE["x"] > 0


def test_gripper_is_closed():
    assert robot.STATE["gripper"] == 1


def test_finish():
    mission.finish()


def test_part_was_dropped():
    assert robot.STATE["dropped"] == [0.2]
