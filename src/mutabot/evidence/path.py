"""Paths of points: made simple, and how far a point lies beside one."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import dist, sqrt

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
        far, where = 0.0, first
        for number in range(first + 1, last):
            distance = _beside(points[number], points[first], points[last])
            if distance > far:
                far, where = distance, number
        if far > tolerance:
            kept.add(where)
            waiting += [(first, where), (where, last)]
    return [points[number] for number in sorted(kept)]


def aside(point: Point, path: Sequence[Point]) -> float:
    """The distance of a point from a path, m."""
    if len(path) == 1:
        return dist(point, path[0])
    return min(_beside(point, one, other) for one, other in pairwise(path))


def _beside(point: Point, one: Point, other: Point) -> float:
    """The distance of a point from the line between two others."""
    px, py, pz = point
    ax, ay, az = one
    dx, dy, dz = other[0] - ax, other[1] - ay, other[2] - az
    length = dx * dx + dy * dy + dz * dz
    share = ((px - ax) * dx + (py - ay) * dy + (pz - az) * dz) / length if length else 0.0
    share = min(1.0, max(0.0, share))
    x, y, z = px - ax - share * dx, py - ay - share * dy, pz - az - share * dz
    return sqrt(x * x + y * y + z * z)
