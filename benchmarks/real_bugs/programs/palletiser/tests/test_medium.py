"""Where the boxes come."""

import pytest
from robot import Cup, Robot, Scale

from program import PICK, Palletiser


def made(**more):
    robot = Robot()
    return Palletiser(robot, Cup(robot, **more), Scale())


def test_a_pallet_has_room_for_24():
    palletiser = made()
    assert not palletiser.run(25)
    assert palletiser.count == 24


def test_the_first_slot():
    assert made().slot(0) == pytest.approx((0.7, -0.25, 0.3, 0.0))


def test_the_second_slot_is_beside_it():
    assert made().slot(1) == pytest.approx((1.11, -0.25, 0.3, 0.0))


def test_the_second_row():
    assert made().slot(3)[:2] == pytest.approx((0.7, 0.06))


def test_boxes_are_gripped_where_they_come_and_let_go_at_their_slot():
    palletiser = made()
    palletiser.run(1)
    (grip, at), (release, to) = palletiser.cup.log
    assert (grip, at) == ("grip", PICK)
    assert (release, to) == ("release", pytest.approx((0.7, -0.25, 0.3)))


def test_a_missing_box_is_noted():
    palletiser = made(boxes=0)
    palletiser.run(1)
    assert palletiser.lost == [0]


def test_a_new_pallet_is_empty():
    palletiser = made()
    palletiser.run(2)
    palletiser.new_pallet()
    assert palletiser.count == 0
