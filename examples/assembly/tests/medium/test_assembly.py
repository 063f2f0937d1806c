"""What a careful suite asks: is the pin in the hole, is the screw tight, are faults noticed?"""

from __future__ import annotations

from collections.abc import Callable

import assembling
import pytest
from station import TABLE_TOP, Station

DEEP = 0.003
"""A pin is in if its lower end is so near to the ground of the hole, m."""
LEAST_TORQUE = 1.4
"""That the screw must have taken, Nm."""


def test_the_pin_is_in_and_the_screw_is_tight(station_with: Callable[..., Station]) -> None:
    station = station_with()
    assert assembling.run(station).result == "good"
    assert station.cell.truth.box_position("pin").z < TABLE_TOP + DEEP
    assert station.spindle.tightest > LEAST_TORQUE
    assert not station.lamp.is_on


def test_a_block_that_lies_off_gets_its_pin(station_with: Callable[..., Station]) -> None:
    station = station_with(off=(0.001, -0.001))
    assert assembling.run(station).result == "good"
    assert station.cell.truth.box_position("pin").z < TABLE_TOP + DEEP


@pytest.mark.parametrize(("screw", "result"), [("crossed", "screw crossed"), ("stripped", "screw stripped")])
def test_a_bad_screw_is_reported(station_with: Callable[..., Station], screw: str, result: str) -> None:
    station = station_with(screw=screw)
    assert assembling.run(station).result == result
    assert station.lamp.is_on


def test_a_missing_block_is_reported(station_with: Callable[..., Station]) -> None:
    assert assembling.run(station_with(block=False)).result == "no block"
