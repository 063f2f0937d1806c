"""It measures something."""

from program import Gauge


def test_a_box_has_a_height(new_cell, mutabot_seed):
    assert Gauge(new_cell(mutabot_seed)).measure()["height"] > 20


def test_it_counts(new_cell, mutabot_seed):
    gauge = Gauge(new_cell(mutabot_seed))
    gauge.measure()
    assert sum(gauge.summary().values()) >= 1
