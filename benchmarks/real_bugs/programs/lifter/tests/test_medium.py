"""Where the box ends, and the arm."""

import pytest
from mutabot_cell import Box, Scene
from program import Lifter


@pytest.mark.parametrize("along", [0.15, -0.2])
def test_the_box_ends_where_it_was_sent(new_cell, mutabot_seed, along):
    cell = new_cell(mutabot_seed)
    before = cell.truth.box_position()
    assert Lifter(cell).shift(along) == "shifted"
    after = cell.truth.box_position()
    assert after.x == pytest.approx(before.x, abs=0.005)
    assert after.y == pytest.approx(before.y + along, abs=0.005)
    assert after.z == pytest.approx(1.0, abs=0.002)


def test_the_arm_ends_at_home(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    home = cell.truth.tool_pose()
    Lifter(cell).shift(0.1)
    assert cell.truth.tool_pose().z == pytest.approx(home.z, abs=0.002)
    assert cell.truth.tool_pose().x == pytest.approx(home.x, abs=0.002)


def test_nothing_is_nothing(new_cell, mutabot_seed):
    lifter = Lifter(new_cell(mutabot_seed, scene=Scene(parts=())))
    assert lifter.shift(0.2) == "nothing there"
    assert lifter.grips == 0


def test_a_box_on_the_table_is_none_on_the_conveyor(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed, scene=Scene(parts=(Box(position=(-0.5, 0.2, 0.76)),)))
    assert Lifter(cell).shift(0.1) == "nothing there"
