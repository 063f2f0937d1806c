"""Paths: fewer points, and how far beside one something is."""

from __future__ import annotations

from math import dist

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

from mutabot.evidence.paths import Point, aside, simple

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
    assert aside([point], points) <= min(dist(point, one) for one in points) + 1e-9


@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(POINTS, POINTS)
def test_several_points_are_as_far_as_the_farthest(points: list[Point], path: list[Point]) -> None:
    assert aside(points, path) == max(aside([point], path) for point in points)
