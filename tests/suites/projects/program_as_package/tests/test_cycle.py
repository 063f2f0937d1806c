import line
import pytest
from robot import Robot


@pytest.fixture(scope="module")
def robot():
    return Robot()


@pytest.fixture(scope="module")
def grabbed(robot):
    return line.cycle(robot)


def test_grabbed(grabbed):
    assert grabbed


def test_log(robot, grabbed):
    assert robot.gripper.log == [(1, 0.0), (0, 1.0)]


def test_last_joints(robot, grabbed):
    assert robot.angles[2] == -0.25
