"""Paths: fewer points, and how far beside one something is."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from math import cos, dist, nan, sin

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

from mutabot.evidence.paths import Point, TrackPath, aside, simple
from mutabot.evidence.recording import Track, TrackKind

POINTS = some.lists(some.tuples(*[some.floats(-2.0, 2.0, width=32)] * 3), min_size=1, max_size=30)


@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(POINTS, some.floats(0.001, 0.5))
def test_what_is_left_out_lies_within_the_tolerance(points: list[Point], tolerance: float) -> None:
    kept = simple(points, tolerance)
    assert kept[0] == points[0]
    assert kept[-1] == points[-1]
    assert aside(points, kept) <= tolerance + 1e-9


def test_a_straight_line_is_two_points() -> None:
    assert simple([(x / 10, 0.0, 0.0) for x in range(11)], 0.001) == [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]


@pytest.mark.parametrize(
    ("point", "distance"),
    [((0.5, 0.2, 0.0), 0.2), ((-1.0, 0.0, 0.0), 1.0), ((1.0, 0.0, 3.0), 3.0), ((0.25, 0.0, 0.0), 0.0)],
)
def test_the_distance_from_a_line_is_that_of_its_nearest_point(point: Point, distance: float) -> None:
    assert aside([point], [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]) == pytest.approx(distance)


@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(POINTS, some.tuples(*[some.floats(-2.0, 2.0)] * 3))
def test_a_path_is_no_farther_than_any_of_its_points(points: list[Point], point: Point) -> None:
    assert aside([point], points) <= min(dist(point, vertex) for vertex in points) + 1e-9


def path_of(points: Sequence[Point], rate: float = 10.0) -> TrackPath:
    track = Track("tool", TrackKind.POINT, values=[number for point in points for number in point])
    return TrackPath(track, [number / rate for number in range(len(points))])


def arc(shift: float, radius: float = 0.6, speed: float = 1.0) -> TrackPath:
    """A quarter of a circle, ten moments a second, each a part of one later."""
    angles = [speed / radius * (number + shift) / 10 for number in range(9)]
    return path_of([(radius * cos(angle), radius * sin(angle), 0.0) for angle in angles])


@pytest.mark.parametrize("shift", [0.25, 0.5])
def test_the_same_curve_seen_at_other_moments_is_no_other_path(shift: float) -> None:
    before, after = arc(0.0), arc(shift)
    inner = after.points[:-1]
    assert aside(inner, before.outline) > 0.0015
    assert aside(inner, before.outline, before.bows) == 0.0


def test_what_leaves_a_curve_is_seen_beside_it() -> None:
    before = arc(0.0)
    beside = [(x * 1.02, y * 1.02, 0.0) for x, y, _ in before.points[1:-1]]
    assert aside(beside, before.outline, before.bows) == pytest.approx(0.012, abs=0.003)


def test_what_is_not_known_of_a_curve_is_not_allowed_beside_a_line() -> None:
    line = path_of([(number**2 / 100, 0.0, 0.0) for number in range(9)])
    assert aside([(0.3, 0.0015, 0.0)], line.outline, line.bows) == pytest.approx(0.0015)


def test_a_leap_into_another_world_says_nothing_about_curves() -> None:
    track = Track("tool", TrackKind.POINT, values=[0, 0, 0, 0.1, 0, 0, 0.1, 0.5, 0, 0.2, 0.5, 0])
    path = TrackPath(track, [0.0, 0.1, 0.101, 0.2])
    assert not any(path.bows)


@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(POINTS, POINTS)
def test_several_points_are_as_far_as_the_farthest(points: list[Point], path: list[Point]) -> None:
    assert aside(points, path) == max(aside([point], path) for point in points)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_a_corner_between_two_moments_may_be_anywhere_between_them(share: float) -> None:
    along = [((number - share) / 10, 0.0, 0.0) for number in range(-4, 1)]
    before = path_of([*along, *((0.0, (number - share) / 10, 0.0) for number in range(1, 5))])
    assert aside([(0.0, 0.0, 0.0)], before.outline) > 0.01
    assert aside([(0.0, 0.0, 0.0)], before.outline, before.bows) == 0.0


def test_a_line_is_not_there_as_long_as_one_of_its_points_is_not() -> None:
    values = array("f", [0.0, 0.0, 0.0, nan, nan, nan, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
    line = Track("arm", TrackKind.LINE, values, radii=(0.1, 0.1))
    assert TrackPath(line, [0.0, 0.1]).when == [0.1]
