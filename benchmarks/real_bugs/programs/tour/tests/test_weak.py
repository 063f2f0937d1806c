"""The arm moves."""

from program import Tour


def test_it_goes_somewhere(new_cell, mutabot_seed):
    assert Tour(new_cell(mutabot_seed)).visit(["conveyor", "home"])


def test_it_creeps(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    before = cell.arm.commanded_joints()
    Tour(cell).creep("camera", lambda: False)
    assert cell.arm.commanded_joints() != before
