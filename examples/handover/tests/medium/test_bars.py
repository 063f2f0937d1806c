"""What a careful suite asks: where do the bars end, and do both robots go on after what can happen?"""

from __future__ import annotations

import math
from collections.abc import Callable

import line
from station import OUTFEED, TABLE_TOP, Station

WITHIN = 0.010
"""Of a bar's place on the outfeed, m."""
GIVEN = {"left": ["given", "given"], "right": ["put down", "put down"]}


def is_put_down(station: Station, number: int) -> bool:
    """Whether a bar lies at its place on the outfeed."""
    found, (x, y) = station.cell.truth.box_position(f"bar {number}"), OUTFEED[number]
    return math.hypot(found.x - x, found.y - y) < WITHIN and abs(found.z - TABLE_TOP) < 0.001


def test_both_bars_lie_at_their_places(station_with: Callable[..., Station]) -> None:
    station = station_with()
    assert line.run(station) == GIVEN
    assert all(is_put_down(station, number) for number in range(2))


def test_a_single_bar_is_handed_over_and_both_robots_end(station_with: Callable[..., Station]) -> None:
    station = station_with(count=1)
    assert line.run(station) == {"left": ["given", "nothing there"], "right": ["put down"]}
    assert is_put_down(station, 0)


def test_both_robots_go_on_when_a_person_has_left(station_with: Callable[..., Station]) -> None:
    station = station_with(walk=((4.0, 3.0), (5.5, 0.6), (9.0, 0.6), (10.5, 3.0)))
    assert line.run(station) == GIVEN
    assert all(is_put_down(station, number) for number in range(2))


def test_an_outfeed_that_stays_full_is_reported(station_with: Callable[..., Station]) -> None:
    station = station_with(blocked=(0.0, 1000.0))
    assert line.run(station) == {"left": ["given", "zone taken"], "right": ["outfeed full"]}
