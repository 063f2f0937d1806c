"""Tracks with fewer points are still where the things were."""

from __future__ import annotations

from array import array
from bisect import bisect_right
from itertools import accumulate
from math import dist, nan, sin
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from mutabot.evidence.recording import Track, TrackKind
from mutabot.report.html.folder import thinned

_PLACES = st.lists(
    st.tuples(*[st.floats(-2, 2, width=32, allow_subnormal=False)] * 3), min_size=1, max_size=30
)


def point(places: Any) -> Track:
    return Track("box", TrackKind.POINT, array("f", [value for place in places for value in place]))


def decoded(data: Any) -> tuple[list[float], list[tuple[float, ...]]]:
    """Times and rows, as the page reads them."""
    times = [time / 1000 for time in accumulate(data["t"])]
    channels = [
        [step * scale for step in accumulate(steps)]
        for steps, scale in zip(data["v"], data["scales"], strict=True)
    ]
    return times, [*zip(*channels, strict=True)]


def at(times: list[float], rows: list[tuple[float, ...]], time: float) -> tuple[float, ...]:
    index = max(0, min(len(times) - 2, bisect_right(times, time + 1e-9) - 1))
    if len(times) == 1:
        return rows[0]
    span = times[index + 1] - times[index]
    share = min(1.0, max(0.0, (time - times[index]) / span)) if span else 0.0
    return tuple(a + share * (b - a) for a, b in zip(rows[index], rows[index + 1], strict=True))


@given(_PLACES)
def test_every_point_is_within_a_millimetre_of_the_line(places: Any) -> None:
    times = [0.1 * number for number in range(len(places))]
    track = point(places)
    made = decoded(thinned(track, times))
    for time, place in zip(times, places, strict=True):
        assert dist(at(*made, time), place) < 1e-3


def test_a_straight_way_is_two_points_and_a_stay_as_well() -> None:
    times = [0.1 * number for number in range(100)]
    assert len(thinned(point([(time, 0.0, 1.0) for time in times]), times)["t"]) == 2
    assert len(thinned(point([(1.0, 0.0, 1.0)] * 100), times)["t"]) == 2


def test_a_curve_keeps_fewer_points_than_it_has() -> None:
    times = [0.01 * number for number in range(1000)]
    assert len(thinned(point([(sin(time), 0.0, 0.0) for time in times]), times)["t"]) < 150


def test_where_a_thing_is_not_there_is_a_gap() -> None:
    times = [0.0, 0.1, 0.2, 0.3]
    data = thinned(point([(0, 0, 0), (nan,) * 3, (nan,) * 3, (1, 0, 0)]), times)
    assert data["gaps"] == [[100, 300]]
    assert thinned(point([(nan,) * 3]), [0.0]) is None


def test_the_two_quaternions_of_a_pose_are_no_jump() -> None:
    values = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0]
    data = thinned(Track("tool", TrackKind.POSE, array("f", values)), [0.0, 0.1])
    assert data["v"][3] == [1000, 0]


def test_a_value_keeps_a_hundredth_of_its_range() -> None:
    times = [0.01 * number for number in range(500)]
    values = [1e-6 * sin(time) for time in times]
    track = Track("current", TrackKind.VALUE, array("f", values), "A")
    made = decoded(thinned(track, times))
    assert all(abs(at(*made, time)[0] - value) < 2e-8 for time, value in zip(times, values, strict=True))


def test_a_line_is_where_its_points_were_to_half_a_centimetre() -> None:
    times = [0.01 * number for number in range(500)]
    rows = [(sin(time), 0.0, 0.0, 0.0, 2 * sin(time), 1.0) for time in times]
    track = Track(
        "arm", TrackKind.LINE, array("f", [value for row in rows for value in row]), radii=(0.1, 0.2)
    )
    data = thinned(track, times)
    made = decoded(data)
    assert data["radii"] == [0.1, 0.2]
    assert len(data["t"]) < 60
    for time, row in zip(times, rows, strict=True):
        assert all(abs(seen - value) < 0.006 for seen, value in zip(at(*made, time), row, strict=True))
