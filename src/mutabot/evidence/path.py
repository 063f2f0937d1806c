"""Paths of points: made simple, and how far points lie beside one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import dist, inf, sqrt

Point = tuple[float, float, float]


def simple(points: Sequence[Point], tolerance: float) -> list[Point]:
    """Some of the points, so that all others lie within ``tolerance`` (m) of the lines between these.

    Source: D. H. Douglas, T. K. Peucker: Algorithms for the reduction of the number of points required to
    represent a digitized line or its caricature. Cartographica 10 (1973), pp. 112-122.
    """
    if len(points) < 3:
        return list(points)
    kept = {0, len(points) - 1}
    waiting = [(0, len(points) - 1)]
    while waiting:
        first, last = waiting.pop()
        far, where = _farthest(points, first, last)
        if far > tolerance:
            kept.add(where)
            waiting += [(first, where), (where, last)]
    return [points[number] for number in sorted(kept)]


def _farthest(points: Sequence[Point], first: int, last: int) -> tuple[float, int]:
    """How far the points between two others are from the line between these at most, and which is."""
    ax, ay, az = points[first]
    bx, by, bz = points[last]
    dx, dy, dz = bx - ax, by - ay, bz - az
    length = dx * dx + dy * dy + dz * dz
    far, where = 0.0, first
    # written out: this is asked of every moment of every mutant
    for number in range(first + 1, last):
        px, py, pz = points[number]
        px, py, pz = px - ax, py - ay, pz - az
        share = (px * dx + py * dy + pz * dz) / length if length else 0.0
        share = 0.0 if share < 0.0 else 1.0 if share > 1.0 else share
        x, y, z = px - share * dx, py - share * dy, pz - share * dz
        square = x * x + y * y + z * z
        if square > far:
            far, where = square, number
    return sqrt(far), where


def aside(points: Iterable[Point], path: Sequence[Point]) -> float:
    """The largest distance of points from a path, m."""
    if len(path) == 1:
        return max(dist(point, path[0]) for point in points)
    lines = [(*one, *_towards(one, other)) for one, other in pairwise(path)]
    worst = 0.0
    for point in points:
        worst = max(worst, _square_beside(point, lines, worst))
    return sqrt(worst)


def _towards(one: Point, other: Point) -> tuple[float, float, float, float]:
    """From a point to another, and the square of how far that is."""
    dx, dy, dz = other[0] - one[0], other[1] - one[1], other[2] - one[2]
    return dx, dy, dz, dx * dx + dy * dy + dz * dz


def _square_beside(point: Point, lines: Iterable[tuple[float, ...]], enough: float) -> float:
    """The square of a point's distance from lines; if it is at most ``enough``, anything that is no more."""
    px, py, pz = point
    least = inf
    for ax, ay, az, dx, dy, dz, length in lines:
        x, y, z = px - ax, py - ay, pz - az
        share = (x * dx + y * dy + z * dz) / length if length else 0.0
        if share > 0.0:
            share = min(share, 1.0)
            x, y, z = x - share * dx, y - share * dy, z - share * dz
        square = x * x + y * y + z * z
        if square < least:
            least = square
            if least <= enough:
                break
    return least
