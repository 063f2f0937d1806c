"""What a first suite asks: does the robot say that it is done, and is the bin empty?"""

from __future__ import annotations

from collections.abc import Callable

import picking
from readings import in_bin
from station import Station


def test_the_bin_is_emptied(station_with: Callable[..., Station]) -> None:
    station = station_with(parts=3)
    assert picking.run(station.cell).result == "empty"
    assert in_bin(station) == []


def test_an_empty_bin_is_reported(station_with: Callable[..., Station]) -> None:
    assert picking.run(station_with(parts=0).cell).result == "empty"
