"""What a first suite asks: does the robot say that it is done?"""

from __future__ import annotations

from collections.abc import Callable

import assembling
from station import Station


def test_a_housing_is_reported_good(station_with: Callable[..., Station]) -> None:
    assert assembling.run(station_with()).result == "good"


def test_an_empty_feeder_is_reported(station_with: Callable[..., Station]) -> None:
    assert assembling.run(station_with(pin=False)).result == "no pin"
