"""What goes in comes out."""

from robot import Pipette, Rack

from program import Transfers


def test_as_much_comes_out_as_goes_in():
    pipette = Pipette()
    Transfers(pipette, Rack()).transfer(50.0, 10.0, 20.0)
    assert pipette.volume == 0.0
    assert ("aspirate", 50.0, 100.0) in pipette.log


def test_a_tip_is_used():
    rack = Rack()
    Transfers(Pipette(), rack).transfer(50.0, 10.0, 20.0)
    assert rack.count == 7


def test_it_ends_at_a_safe_height_without_a_tip():
    pipette = Pipette()
    Transfers(pipette, Rack()).transfer(50.0, 10.0, 20.0)
    assert pipette.height == 200.0
    assert not pipette.has_tip
