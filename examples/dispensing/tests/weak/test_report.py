"""What a first suite asks: does the robot say that it is done?"""

from __future__ import annotations

from collections.abc import Callable

import sealing
from station import Station


def test_a_housing_is_reported_sealed(station_with: Callable[..., Station]) -> None:
    station = station_with()
    assert sealing.run(station).result == "sealed"
    assert station.dispenser.drops


def test_an_empty_fixture_is_reported(station_with: Callable[..., Station]) -> None:
    assert sealing.run(station_with(is_empty=True)).result == "no housing"
