"""Boxes are stacked."""

from robot import Cup, Robot, Scale

from program import Palletiser


def made(**more):
    robot = Robot()
    return Palletiser(robot, Cup(robot, **more), Scale())


def test_a_box():
    assert made().run(1)


def test_boxes_are_counted():
    palletiser = made()
    palletiser.run(3)
    assert palletiser.count == 3


def test_no_box():
    palletiser = made(boxes=0)
    palletiser.run(1)
    assert palletiser.count == 0
