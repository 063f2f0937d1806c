"""A seam is welded."""

from robot import Arm, Source

from program import Welder

SEAM = [(0.2, 0.0, 0.0), (0.5, 0.0, 0.0)]


def test_a_seam():
    assert Welder(Arm(), Source()).weld(SEAM, 4.0)


def test_without_gas():
    assert not Welder(Arm(), Source(gas=0.0)).weld(SEAM, 4.0)


def test_park():
    arm = Arm()
    Welder(arm, Source()).park()
    assert arm.log


def test_the_arc_was_on():
    source = Source()
    Welder(Arm(), source).weld(SEAM, 4.0)
    assert "on" in source.log
