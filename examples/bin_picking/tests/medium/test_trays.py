"""What a careful suite asks: how many parts are where, and what if the cup does not hold?"""

from __future__ import annotations

from collections.abc import Callable

import picking
from readings import in_trays
from station import MASSES, Station


def test_each_part_lies_in_the_tray_of_its_shape(station_with: Callable[..., Station]) -> None:
    station = station_with(parts=6)
    report = picking.run(station.cell)
    assert report.result == "empty"
    assert report.placed == dict.fromkeys(MASSES, 2)
    assert in_trays(station) == report.placed


def test_a_cup_that_leaks_ends_the_work(station_with: Callable[..., Station]) -> None:
    station = station_with(parts=1)
    station.cell.suction.leak = 1e-4
    assert picking.run(station.cell).result == "nothing graspable"
