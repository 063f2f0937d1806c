"""How the box is handled: height, tilt, force, second tries, time."""

import pytest
from mutabot_cell import Box, Scene
from program import Lifter


def test_the_box_is_lifted_well_clear_and_stays_upright(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    heights = []

    def is_upright():
        heights.append(cell.truth.box_position().z)
        return cell.truth.box_tilt() < 3

    cell.always(is_upright, "the box stays upright")
    Lifter(cell).shift(0.1)
    assert max(heights) == pytest.approx(1.12, abs=0.005)


def test_the_box_is_not_dropped(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    fastest = []

    def is_calm():
        if cell.gripper.commanded() < 0.5:
            fastest.append(cell.truth.box_speed())
        return True

    cell.always(is_calm, "the box is watched")
    Lifter(cell).shift(0.1)
    assert max(fastest) < 0.3


def test_a_light_box_is_gripped_once_and_gently(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    lifter = Lifter(cell)
    forces = []
    set_force = cell.gripper.set_force
    cell.gripper.set_force = lambda newtons: (forces.append(newtons), set_force(newtons))
    lifter.shift(0.1)
    assert (lifter.grips, forces) == (1, [40])


def test_a_heavy_box_is_gripped_again_more_firmly(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed, scene=Scene(parts=(Box(mass=0.3, friction=0.025),)))
    lifter = Lifter(cell)
    forces = []
    set_force = cell.gripper.set_force
    cell.gripper.set_force = lambda newtons: (forces.append(newtons), set_force(newtons))
    lifter.shift(0.1)
    assert (lifter.grips, forces) == (2, [40, 120])


def test_a_box_that_slips_twice_is_left_there(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed, scene=Scene(parts=(Box(mass=0.3, friction=0.004),)))
    lifter = Lifter(cell)
    assert lifter.shift(0.1) == "slipped"
    assert lifter.grips == 2
    assert cell.truth.opening() > 0.08


def test_a_gripper_that_is_closed_opens_first(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    cell.gripper.command(1)
    cell.wait(1.0)
    assert Lifter(cell).shift(0.1) == "shifted"


def test_a_second_box_is_gripped_once_too(new_cell, mutabot_seed):
    lifter = Lifter(new_cell(mutabot_seed))
    lifter.shift(0.1)
    assert lifter.shift(-0.1) == "shifted"
    assert lifter.grips == 1


def test_a_narrow_box_is_not_what_it_wants(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed, scene=Scene(parts=(Box(size=(0.035, 0.035, 0.05)),)))
    assert Lifter(cell).shift(0.1) == "slipped"


def test_it_takes_no_longer_than_it_must(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    Lifter(cell).shift(0.1)
    assert cell.time < 13.0
