"""Heights, speeds, limits and the count of tips."""

import pytest
from robot import Pipette, Rack

from program import Transfers


def test_the_tip_reaches_the_well():
    pipette = Pipette()
    Transfers(pipette, Rack()).at(10.0)
    assert pipette.height == pytest.approx(69.9)


def test_between_wells_it_is_safe():
    pipette = Pipette()
    Transfers(pipette, Rack()).at(10.0)
    assert pipette.log[0] == ("height", 200.0)


def test_what_is_viscous_goes_slowly():
    pipette = Pipette()
    Transfers(pipette, Rack()).transfer(50.0, 10.0, 20.0, viscous=True)
    assert ("aspirate", 50.0, 20.0) in pipette.log
    assert ("dispense", 50.0, 20.0) in pipette.log


@pytest.mark.parametrize("volume", [0.5, 200.5])
def test_a_wrong_volume_is_refused(volume):
    with pytest.raises(ValueError, match="µl"):
        Transfers(Pipette(), Rack()).transfer(volume, 10.0, 20.0)


def test_who_gives_up_gives_the_tip_back():
    rack = Rack(3)
    Transfers(Pipette(), rack).give_up()
    assert rack.count == 4


def test_a_rinse_leaves_nothing():
    pipette = Pipette()
    Transfers(pipette, Rack()).rinse(2)
    assert pipette.volume == 0.0
    assert pipette.log.count(("aspirate", 50.0, 20.0)) == 2
