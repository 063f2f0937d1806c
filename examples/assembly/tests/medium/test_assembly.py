"""What a careful suite asks: are pin and cover in their places, are the screws tight, are faults noticed?"""

from __future__ import annotations

from collections.abc import Callable

import assembling
import pytest
from station import RIM, TABLE_TOP, Station

NEAR = 0.003
"""Pin and cover are in their places if they are so near, m."""
LEAST_TORQUE = 1.4
"""That each screw must have taken, Nm."""


def test_pin_and_cover_are_in_and_the_screws_are_tight(station_with: Callable[..., Station]) -> None:
    station = station_with(off=(0.001, -0.001))
    report = assembling.run(station)
    assert report.result == "good"
    assert len(report.angles) == 4
    assert station.cell.truth.box_position("pin").z < TABLE_TOP + NEAR
    assert station.cell.truth.box_position("cover").z < TABLE_TOP + RIM + NEAR
    assert min(screw.tightest for screw in station.driver.screws) > LEAST_TORQUE
    assert not station.lamp.is_on


@pytest.mark.parametrize(("screw", "result"), [("crossed", "screw crossed"), ("stripped", "screw stripped")])
def test_a_bad_screw_is_reported(station_with: Callable[..., Station], screw: str, result: str) -> None:
    station = station_with(screw=screw)
    assert assembling.run(station).result == result
    assert station.lamp.is_on


@pytest.mark.parametrize(
    ("missing", "result"), [("block", "no block"), ("cover", "no cover"), ("driver", "no screwdriver")]
)
def test_what_is_missing_is_reported(station_with: Callable[..., Station], missing: str, result: str) -> None:
    assert assembling.run(station_with(**{missing: False})).result == result
