"""How the boxes are stacked."""

import pytest
from robot import Cup, Robot, Scale

from program import Palletiser


def made(grams=5000.0, **more):
    robot = Robot()
    return Palletiser(robot, Cup(robot, **more), Scale(grams))


def test_the_second_layer_is_turned_and_begins_at_the_other_end():
    assert made().slot(6) == pytest.approx((1.52, 0.06, 0.5, 180.0))


def test_the_third_layer_is_as_the_first():
    assert made().slot(12)[3] == 0.0
    assert made().slot(12)[2] == pytest.approx(0.7)


def test_a_box_comes_from_above():
    palletiser = made()
    palletiser.run(1)
    heights = [one[2] for one in palletiser.robot.log]
    assert heights == pytest.approx([0.55, 0.3, 0.55, 0.55, 0.3, 0.55])


@pytest.mark.parametrize(("grams", "speed"), [(5000.0, 0.75), (10000.0, 0.5), (20000.0, 0.2)])
def test_heavy_boxes_are_carried_slowly(grams, speed):
    palletiser = made(grams)
    palletiser.run(1)
    assert palletiser.robot.log[3][4] == pytest.approx(speed)


def test_heavy_boxes_are_put_down_slowly():
    light, heavy = made(11900.0), made(12100.0)
    light.run(1)
    heavy.run(1)
    assert (light.robot.log[4][4], heavy.robot.log[4][4]) == (0.3, 0.1)


def test_without_vacuum_the_cup_is_let_go_and_nothing_is_carried():
    palletiser = made(boxes=0)
    palletiser.run(1)
    assert [one[0] for one in palletiser.cup.log] == ["grip", "release"]
    assert len(palletiser.robot.log) == 2


def test_the_lost_boxes_are_handed_out_with_the_pallet():
    palletiser = made(boxes=1)
    palletiser.run(2)
    assert palletiser.new_pallet() == [1]
    assert palletiser.lost == []


def test_a_new_pallet_has_lost_nothing():
    palletiser = made(boxes=0)
    palletiser.run(2)
    palletiser.new_pallet()
    assert palletiser.new_pallet() == []


def test_the_turn_is_sent():
    palletiser = made()
    palletiser.run(7)
    assert palletiser.robot.log[-1][3] == 180.0
