"""What the plant asks of the line: at every moment, and after everything that may happen in it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import line
import pytest
from station import OUTFEED, TABLE_TOP, Station
from watch import watch

GIVEN = {"left": ["given", "given"], "right": ["put down", "put down"]}
WITHIN, LEVEL = 0.004, 0.001
"""Of a bar's place on the outfeed, along the bar and across, and in height, m: 1 mm of the place it was
taken from, 2 mm that it may slide in each hand."""
CYCLE_TIME = 30.0
"""Of two bars, s."""


def run_watched(station: Station) -> dict[str, list[str]]:
    """Run the line while everything is watched; at the end the messages under way arrive."""
    watch(station)
    reports = line.run(station)
    station.cell.wait(0.2 + station.signals.late)
    return reports


def check_put_down(station: Station, count: int) -> None:
    """The bars lie at their places, and neither hand holds one."""
    for number, (x, y) in enumerate(OUTFEED[:count]):
        found = station.cell.truth.box_position(f"bar {number}")
        assert (found.x, found.y) == pytest.approx((x, y), abs=WITHIN)
        assert found.z == pytest.approx(TABLE_TOP, abs=LEVEL)


def check_at_rest(station: Station) -> None:
    """No signal is on, the zone is free, both hands are open and both robots are out of the middle."""
    assert station.signals.all_on() == []
    assert station.zone.owner == ""
    for name, robot in station.cell.robots.items():
        pose = station.cell.truth.tool_pose(name)
        assert not robot.gripper.holding()
        assert math.hypot(pose.x - 0.54, pose.y) > 0.2


def test_two_bars_are_handed_over_in_time(station_with: Callable[..., Station]) -> None:
    station = station_with()
    assert run_watched(station) == GIVEN
    assert station.cell.time < CYCLE_TIME
    check_put_down(station, 2)
    check_at_rest(station)


@pytest.mark.parametrize("shift", [1, 2])
def test_two_bars_are_handed_over_whatever_the_order_and_the_bus(
    station_with: Callable[..., Station], shift: int
) -> None:
    station = station_with(late=0.15 * shift)
    station = replace(station, seed=station.seed + 1000 * shift)
    assert run_watched(station) == GIVEN
    check_put_down(station, 2)
    check_at_rest(station)


def test_the_left_robot_waits_while_the_right_one_stands_in_the_middle_with_a_bar(
    station_with: Callable[..., Station],
) -> None:
    station = station_with(blocked=(0.0, 18.0))
    assert run_watched(station) == GIVEN
    check_put_down(station, 2)
    check_at_rest(station)


@pytest.mark.parametrize("start", [2.0, 8.0, 12.0])
def test_both_robots_stop_beside_a_person_and_go_on_afterwards(
    station_with: Callable[..., Station], start: float
) -> None:
    station = station_with(
        walk=((start, 2.9), (start + 1.5, 0.5), (start + 4.0, 0.5), (start + 5.5, 2.9)), count=1
    )
    assert run_watched(station) == {"left": ["given", "nothing there"], "right": ["put down"]}
    check_put_down(station, 1)
    check_at_rest(station)


def test_an_outfeed_that_stays_full_is_reported_and_the_left_robot_puts_its_bar_back(
    station_with: Callable[..., Station],
) -> None:
    station = station_with(blocked=(0.0, 1000.0))
    assert run_watched(station) == {"left": ["given", "zone taken"], "right": ["outfeed full"]}
    assert station.cell.truth.box_position("bar 1").z == pytest.approx(TABLE_TOP, abs=LEVEL)
    assert station.zone.owner == "right"


def test_an_empty_infeed_is_reported_and_both_robots_are_at_rest(
    station_with: Callable[..., Station],
) -> None:
    station = station_with(count=0)
    assert run_watched(station) == {"left": ["nothing there"], "right": []}
    check_at_rest(station)
