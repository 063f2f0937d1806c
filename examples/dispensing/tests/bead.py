"""The bead that lies on the housing, from what left the nozzle: the oracle."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from sealing import ROUND
from station import REACHES, STRINGS, Station

Array = NDArray[np.float64]

PIECE = 0.010
"""The bead is looked at in even pieces of about this length along the seam, m: each takes 17 drops."""
_BESIDE = 0.003
_FINE = 0.00025


def narrowest(station: Station) -> float:
    """Least width of the bead on any piece between the first and the last, m."""
    return float(widths(station)[1:-1].min())


def widest(station: Station) -> float:
    """Greatest width of the bead on any piece, m."""
    return float(widths(station).max())


def amount(station: Station) -> float:
    """All that was dispensed, m³."""
    return sum(drop.volume for drop in station.dispenser.drops)


def aside(station: Station) -> float:
    """How far beside the groove any sealant lies, m: what lies beyond its two ends is not beside it."""
    indexes, distances = _nearest(station)
    between = (indexes > 0) & (indexes < len(groove(station.seam)) - 1)
    return float(distances[between].max(initial=0.0))


def spilled(station: Station) -> float:
    """What does not lie in the groove, m³: beside it, dropped from too high, or smeared."""
    _, distances = _nearest(station)
    return sum(
        drop.volume
        for drop, distance in zip(station.dispenser.drops, distances, strict=True)
        if not STRINGS < drop.height < REACHES or distance > _BESIDE
    )


def widths(station: Station) -> Array:
    """Width of the bead on each piece, m: of half a cylinder with the volume that lies there."""
    indexes, distances = _nearest(station)
    length = length_of(station)
    count = round(length / PIECE)
    pieces = np.minimum((indexes * _FINE / length * count).astype(int), count - 1)
    inside = distances <= _BESIDE
    drops = np.array([drop.volume for drop in station.dispenser.drops])
    volumes = np.bincount(pieces[inside], weights=drops[inside], minlength=count)
    result: Array = np.sqrt(8.0 * volumes / (length / count) / math.pi)
    return result


def length_of(station: Station) -> float:
    """Of the seam, m."""
    return (len(groove(station.seam)) - 1) * _FINE


def groove(corners: list[tuple[float, float]]) -> Array:
    """Places along the groove at even spaces, shape (n, 2), m: straight, with corners rounded by arcs."""
    points = [np.array(corner) for corner in corners]
    strokes, start = list[Array](), points[0]
    for before, corner, after in zip(points, points[1:], points[2:], strict=False):
        first, second = (corner + ROUND * _unit(place - corner) for place in (before, after))
        strokes += [_line(start, first), _arc(first, second, corner)]
        start = second
    strokes.append(_line(start, points[-1]))
    raw = np.concatenate(strokes)
    ways = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(raw, axis=0), axis=1))))
    wanted = np.arange(0.0, ways[-1], _FINE)
    return np.stack([np.interp(wanted, ways, raw[:, axis]) for axis in (0, 1)], axis=1)


def _nearest(station: Station) -> tuple[NDArray[np.intp], Array]:
    """For each drop, number of the nearest place of the groove and the distance to it, m."""
    drops = station.dispenser.drops
    places = np.array([(drop.x, drop.y) for drop in drops]).reshape(len(drops), 1, 2)
    distances = np.linalg.norm(places - groove(station.seam), axis=2)
    return distances.argmin(axis=1), distances.min(axis=1)


def _unit(way: Array) -> Array:
    result: Array = way / np.linalg.norm(way)
    return result


def _line(start: Array, end: Array) -> Array:
    count = max(2, round(float(np.linalg.norm(end - start)) / _FINE))
    return np.linspace(start, end, count)


def _arc(start: Array, end: Array, corner: Array) -> Array:
    """The arc that touches both sides of a corner at these two places."""
    half = math.acos(float(np.clip(_unit(start - corner) @ _unit(end - corner), -1.0, 1.0))) / 2
    inwards = _unit((start + end) / 2 - corner)
    centre = corner + ROUND / math.cos(half) * inwards
    begin, finish = (math.atan2(*(place - centre)[::-1]) for place in (start, end))
    sweep = (finish - begin + math.pi) % (2 * math.pi) - math.pi
    angles = begin + sweep * np.linspace(0.0, 1.0, 60)
    radius = ROUND * math.tan(half)
    return np.stack((centre[0] + radius * np.cos(angles), centre[1] + radius * np.sin(angles)), axis=1)
