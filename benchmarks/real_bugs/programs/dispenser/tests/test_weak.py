"""Transfers end."""

from robot import Pipette, Rack

from program import Transfers


def test_it_ends():
    transfers = Transfers(Pipette(), Rack())
    transfers.transfer(50.0, 10.0, 20.0)
    assert transfers.done


def test_it_gives_up():
    pipette = Pipette()
    Transfers(pipette, Rack()).give_up()
    assert not pipette.has_tip
