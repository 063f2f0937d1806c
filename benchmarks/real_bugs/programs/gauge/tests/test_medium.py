"""It measures what there is."""

import pytest
from mutabot_cell import Box, Scene
from program import Gauge


def test_a_box_of_5_cm(new_cell, mutabot_seed):
    found = Gauge(new_cell(mutabot_seed, scene=Scene(parts=(Box(colour="red"),)))).measure()
    assert found["height"] == pytest.approx(50, abs=2.5)
    assert found["width"] == pytest.approx(50, abs=1)
    assert found["good"] is True
    assert found["colour"] == "red"


def test_no_box_is_none(new_cell, mutabot_seed):
    gauge = Gauge(new_cell(mutabot_seed, scene=Scene(parts=())))
    assert gauge.measure() is None
    assert gauge.summary() == {"good": 0, "red": 0, "blue": 0}


def test_a_flat_box_is_not_good(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed, scene=Scene(parts=(Box(size=(0.05, 0.05, 0.035)),)))
    assert Gauge(cell).measure()["good"] is False
