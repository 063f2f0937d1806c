import pytest
import urx
from controller import Controller

from palletise import HOME, palletise

FEEDER, PALLET = (0.3, -0.2, 0.05), (0.35, 0.25, 0.02)


@pytest.fixture
def controller():
    controller = Controller()
    yield controller
    controller.close()


@pytest.fixture
def robot(controller):
    robot = urx.Robot(controller.host)
    yield robot
    robot.close()


def test_parts_are_taken_from_the_feeder_and_stacked(controller, robot):
    palletise(robot, FEEDER, PALLET, 2)
    taken = [place for closed, place in controller.log if closed]
    put = [place for closed, place in controller.log if not closed]
    assert taken == [pytest.approx(FEEDER, abs=0.001)] * 2
    assert put == [pytest.approx(PALLET, abs=0.001), pytest.approx((0.35, 0.25, 0.05), abs=0.001)]


def test_the_arm_ends_at_home_with_its_tool_up(controller, robot):
    pose = palletise(robot, FEEDER, PALLET, 1)
    assert controller.joints == pytest.approx(HOME)
    assert pose[2] > PALLET[2] + 0.05
