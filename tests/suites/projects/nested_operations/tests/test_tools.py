import mission
from robot import Cell


def test_tool_two():
    cell = Cell()
    cell.x = 0.3
    assert mission.change_tool(cell, 2) == 2
    assert cell.locked


def test_tool_is_shifted_down():
    cell = Cell()
    mission.change_tool(cell, 2)
    assert cell.shifted < 0
