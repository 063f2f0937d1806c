"""Where it goes, and when the arc burns."""

import pytest
from robot import Arm, Source

from program import Welder

SEAM = [(0.2, 0.0, 0.0), (0.5, 0.0, 0.0), (0.5, 0.25, 0.0)]


def welded(thickness=4.0, **more):
    welder = Welder(Arm(), Source())
    welder.weld(SEAM, thickness, **more)
    return welder


def test_the_arc_is_off_at_the_end():
    assert not welded().source.is_on


def test_all_points_are_reached():
    places = [one[:2] for one in welded().arm.log]
    assert places == [(0.2, 0.0), (0.2, 0.0), (0.5, 0.0), (0.5, 0.25), (0.5, 0.25)]


def test_the_length_of_the_seam():
    assert welded().length == pytest.approx(0.55)


def test_one_point_is_no_seam():
    assert not Welder(Arm(), Source()).weld(SEAM[:1], 4.0)


def test_thick_metal_takes_more_current():
    assert welded(6.0).source.amperes > welded(3.0).source.amperes


def test_no_arc_no_seam():
    welder = Welder(Arm(), Source(strikes=False))
    assert not welder.weld(SEAM, 4.0)
    assert welder.faults == 1
