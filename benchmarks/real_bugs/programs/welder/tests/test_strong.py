"""How it is done."""

import pytest
from robot import Arm, Source

from program import HOME, Welder

SEAM = [(0.2, 0.0, 0.1), (0.5, 0.0, 0.1)]


def welded(thickness=4.0, **more):
    welder = Welder(Arm(), Source())
    welder.weld(SEAM, thickness, **more)
    return welder


def test_the_torch_is_above_the_metal():
    heights = [one[2] for one in welded().arm.log]
    assert heights == pytest.approx([0.5, 0.45, 0.45, 0.5])


def test_the_speed_goes_with_the_thickness():
    assert welded(4.0).arm.log[2][3] == pytest.approx(0.0025)


def test_weaving_takes_twice_as_long():
    assert welded(4.0, weave=True).arm.log[2][3] == pytest.approx(0.00125)


def test_the_torch_comes_down_slowly():
    assert welded().arm.log[1][3] == 0.05


@pytest.mark.parametrize(("thickness", "amperes"), [(2.0, 80.0), (4.5, 140.0), (8.0, 200.0)])
def test_the_current(thickness, amperes):
    assert welded(thickness).source.amperes == pytest.approx(amperes)


def test_the_current_is_set_before_the_arc():
    assert [one if isinstance(one, str) else one[0] for one in welded().source.log] == [
        "current",
        "on",
        "off",
    ]


def test_a_second_seam_is_measured_by_itself():
    welder = welded()
    welder.weld(SEAM, 4.0)
    assert welder.length == pytest.approx(0.3)


def test_after_a_fault_the_arm_is_home_and_the_arc_off():
    welder = Welder(Arm(), Source(strikes=False))
    welder.weld(SEAM, 4.0)
    assert welder.arm.place == HOME
    assert not welder.source.is_on


def test_faults_are_forgotten_when_parked():
    welder = Welder(Arm(), Source(strikes=False))
    welder.weld(SEAM, 4.0)
    welder.park()
    assert welder.faults == 0
    assert welder.arm.place[0] == 0.6


def test_no_seam_while_the_arc_burns():
    welder = welded()
    welder.source.on()
    welder.source.wait(1.0)
    assert not welder.weld(SEAM, 4.0)


def test_little_gas_is_not_enough():
    assert not Welder(Arm(), Source(gas=0.4)).weld(SEAM, 4.0)
