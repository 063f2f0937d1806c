"""The box moves."""

from mutabot_cell import Box, Scene
from program import Lifter


def test_a_box_is_shifted(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    before = cell.truth.box_position()
    Lifter(cell).shift(0.2)
    assert abs(cell.truth.box_position().y - before.y) > 0.05


def test_an_empty_conveyor_is_told(new_cell, mutabot_seed):
    assert Lifter(new_cell(mutabot_seed, scene=Scene(parts=()))).shift(0.2) != "shifted"


def test_a_box_elsewhere_is_found(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed, scene=Scene(parts=(Box(position=(0.5, 0.1, 1.0)),)))
    assert Lifter(cell).shift(-0.1) == "shifted"
