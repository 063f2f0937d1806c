"""Other sizes, and what is left behind."""

import pytest
from mutabot_cell import Box, Scene
from program import Gauge


@pytest.mark.parametrize("height", [0.035, 0.057])
def test_heights(new_cell, mutabot_seed, height):
    cell = new_cell(mutabot_seed, scene=Scene(parts=(Box(size=(0.05, 0.05, height)),)))
    found = Gauge(cell).measure()
    assert found["height"] == pytest.approx(1000 * height, abs=2.5)
    assert found["good"] is False


@pytest.mark.parametrize(("width", "good"), [(0.04, False), (0.0488, True), (0.06, False)])
def test_widths(new_cell, mutabot_seed, width, good):
    cell = new_cell(mutabot_seed, scene=Scene(parts=(Box(size=(width, width, 0.05)),)))
    found = Gauge(cell).measure()
    assert found["width"] == pytest.approx(1000 * width, abs=0.6)
    assert found["good"] is good


def test_what_lies_on_the_table_is_not_measured(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed, scene=Scene(parts=(Box(size=(0.05, 0.05, 0.004)),)))
    assert Gauge(cell).measure() is None


def test_the_box_stays_where_it_was_and_the_fingers_open(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    before = cell.truth.box_position()
    Gauge(cell).measure()
    cell.wait(0.5)
    after = cell.truth.box_position()
    assert (after.x, after.y, after.z) == pytest.approx((before.x, before.y, before.z), abs=0.003)
    assert cell.truth.opening() == pytest.approx(0.085, abs=0.001)


def test_the_tool_ends_high(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    Gauge(cell).measure()
    assert cell.arm.commanded_pose().z == pytest.approx(0.25, abs=0.001)


def test_fingers_that_are_closed_do_not_touch_the_box_from_above(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    cell.gripper.command(1)
    cell.wait(1.0)
    assert Gauge(cell).measure()["good"] is True


def test_it_feels_with_little_force(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    forces = []
    set_force = cell.gripper.set_force
    cell.gripper.set_force = lambda newtons: (forces.append(newtons), set_force(newtons))
    Gauge(cell).measure()
    assert forces == [20]


def test_each_colour_is_counted(new_cell, mutabot_seed):
    for colour, other in (("red", "blue"), ("blue", "red")):
        gauge = Gauge(new_cell(mutabot_seed, scene=Scene(parts=(Box(colour=colour),))))
        gauge.measure()
        gauge.measure()
        assert gauge.summary() == {"good": 2, colour: 2, other: 0}
