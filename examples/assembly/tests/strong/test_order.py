"""What the drawing asks of the assembly, and what must hold at every moment."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from station import Station
from watch import MOST_TORQUE, check_assembled, check_at_rest, check_in_chute, check_pin, run_watched

CYCLE_TIME = 75.0
"""From the start to home, s."""


@pytest.mark.parametrize("off", [None, (-0.001, 0.001)])
def test_a_housing_is_assembled_as_drawn_and_in_time(
    station_with: Callable[..., Station], off: tuple[float, float] | None
) -> None:
    station = station_with(off=off)
    report = run_watched(station)
    assert report.result == "good"
    check_assembled(station)
    check_at_rest(station)
    assert report.angles == pytest.approx([screw.angle for screw in station.driver.screws], abs=0.5)
    assert station.cell.time < CYCLE_TIME


def test_a_hole_out_of_reach_makes_a_reject(station_with: Callable[..., Station]) -> None:
    station = station_with(off=(0.006, 0.0))
    assert run_watched(station).result == "not inserted"
    assert station.lamp.is_on
    check_in_chute(station, "pin")
    check_at_rest(station)


def test_a_cover_on_a_chip_is_a_reject_and_is_not_screwed(station_with: Callable[..., Station]) -> None:
    station = station_with(chip=True)
    assert run_watched(station).result == "cover not seated"
    assert station.lamp.is_on
    assert not station.driver.order
    check_in_chute(station, "cover")
    check_at_rest(station)


@pytest.mark.parametrize(
    ("screw", "result"),
    [("crossed", "screw crossed"), ("stripped", "screw stripped"), ("missing", "screw stripped")],
)
def test_a_bad_screw_is_a_reject_and_is_not_torn(
    station_with: Callable[..., Station], screw: str, result: str
) -> None:
    station = station_with(screw=screw)
    report = run_watched(station)
    assert report.result == result
    assert station.lamp.is_on
    assert station.driver.order == [0, 1, 2]
    assert len(report.angles) == 3
    assert max(screw.tightest for screw in station.driver.screws) < MOST_TORQUE
    check_at_rest(station)


@pytest.mark.parametrize("missing", ["pin", "cover"])
def test_what_is_missing_is_reported_and_nothing_is_screwed(
    station_with: Callable[..., Station], missing: str
) -> None:
    station = station_with(**{missing: False})
    assert run_watched(station).result == f"no {missing}"
    assert station.lamp.is_on
    assert not station.driver.order
    check_at_rest(station)
    if missing == "cover":
        check_pin(station)


@pytest.mark.parametrize(("lacks", "result"), [("block", "no block"), ("air", "not clamped")])
def test_the_robot_stays_at_home_without_a_clamped_housing(
    station_with: Callable[..., Station], lacks: str, result: str
) -> None:
    station = station_with(**{lacks: False})
    station.cell.always(lambda: station.cell.truth.tool_speed() < 0.01, "the robot stays at home")
    assert run_watched(station).result == result
    assert station.lamp.is_on
    check_at_rest(station)
