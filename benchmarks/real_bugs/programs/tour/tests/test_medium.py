"""Where the arm goes."""

import pytest
from program import Tour


def test_each_pose_is_visited_in_turn(new_cell, mutabot_seed):
    names = ["conveyor", "camera", "table", "home"]
    assert Tour(new_cell(mutabot_seed)).visit(names) == names


def test_over_the_conveyor_the_tool_looks_down(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    Tour(cell).visit(["conveyor"])
    tool = cell.truth.tool_pose()
    assert (tool.x, tool.y, tool.z) == pytest.approx((0.49, 0.0, 0.30), abs=0.02)


def test_the_table_is_behind(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    Tour(cell).visit(["table"])
    assert cell.truth.tool_pose().x < -0.3


def test_it_waves_as_long_as_it_may(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    answers = iter([False, False, True])
    assert Tour(cell).wave(0, 10, lambda: next(answers)) == 2
