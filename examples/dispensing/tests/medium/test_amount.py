"""What a careful suite asks: is sealant all along, as much as drawn, and are faults noticed?"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
import sealing
from bead import amount, length_of, narrowest
from station import Station

WIDTH = 0.004
"""Of the bead as drawn, m."""
AMOUNT_WITHIN = 0.05
"""Of the whole bead: what two switchings of the valve and both ends are uncertain by."""


def test_the_bead_holds_what_the_drawing_asks_for(station_with: Callable[..., Station]) -> None:
    station = station_with()
    sealing.run(station)
    wanted = math.pi * WIDTH**2 / 8 * length_of(station)
    assert amount(station) == pytest.approx(wanted, rel=AMOUNT_WITHIN)


def test_the_bead_has_no_gap(station_with: Callable[..., Station]) -> None:
    station = station_with()
    sealing.run(station)
    assert narrowest(station) > WIDTH / 2


def test_nothing_is_dispensed_without_a_housing(station_with: Callable[..., Station]) -> None:
    station = station_with(is_empty=True)
    sealing.run(station)
    assert amount(station) == 0.0


def test_a_housing_that_lies_too_far_off_is_reported_and_not_sealed(
    station_with: Callable[..., Station],
) -> None:
    station = station_with(shift=(0.007, 0.002))
    assert sealing.run(station).result == "misplaced"
    assert amount(station) == 0.0


def test_an_empty_cartridge_is_reported_before_anything_moves_to_the_housing(
    station_with: Callable[..., Station],
) -> None:
    station = station_with(level=0.05)
    assert sealing.run(station).result == "cartridge empty"
    assert amount(station) == 0.0


def test_a_needle_that_clogs_is_reported(station_with: Callable[..., Station]) -> None:
    assert sealing.run(station_with(clogs_at=3.0)).result == "clogged"
