"""What a watched cell did, worked out from every control tick."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

Array = np.ndarray[Any, np.dtype[np.float64]]
#: whether something is so, per tick
Truth = np.ndarray[Any, np.dtype[np.bool_]]

#: s: a grip that is lost for less goes on; what falls longer is not followed; before a thing lies by itself
FLICKER, FALL = 0.25, 3.0


class Release(NamedTuple):
    """How a thing was let go: when, how far it fell, onto what, and how fast it was just before the touch."""

    at: float
    fall: float
    onto: str
    speed: float


@dataclass(frozen=True)
class Watched:
    """One cell, watched at each control tick.

    Attributes:
        cell: what the plug-in wrote.
    """

    cell: dict[str, Any]

    @cached_property
    def times(self) -> Array:
        """Of each tick, s."""
        return np.array(self.cell["times"])

    @cached_property
    def poses(self) -> dict[str, Array]:
        """Of tools and parts, a row of seven numbers per tick."""
        return {name: np.array(rows) for name, rows in self.cell["poses"].items()}

    @cached_property
    def values(self) -> dict[str, Array]:
        """Of fingers and limits, one number per tick."""
        return {name: np.array(rows) for name, rows in self.cell["values"].items()}

    @property
    def parts(self) -> list[str]:
        """What a robot can move."""
        return list(self.cell["edges"])

    @property
    def tools(self) -> list[str]:
        """The tools of the robots."""
        return [name for name in self.poses if name not in self.cell["edges"]]

    def touches(self, first: str, second: str) -> Truth:
        """Whether two touch, per tick."""
        pair = tuple(sorted((first, second)))
        return np.array([pair in now for now in self.cell["touching"]])

    @cached_property
    def pairs(self) -> set[tuple[str, str]]:
        """All that touch each other at any time."""
        return set().union(*self.cell["touching"])

    def partners(self, part: str, robot: str = "") -> tuple[Truth, dict[str, Truth]]:
        """Whether a robot touches a part, per tick, and what else but robots does, by its name.

        ``robot``: what the names of the robot's bodies begin with; any robot if that is empty.
        """
        others = {next(member for member in pair if member != part) for pair in self.pairs if part in pair}
        held = np.zeros(len(self.times), dtype=bool)
        rest = {}
        for other in sorted(others):
            found = self.touches(part, other)
            if other not in self.cell["robots"]:
                rest[other] = found
            elif other.startswith(robot):
                held |= found
        return _bridged(held, self.times), rest

    def lowest(self, part: str) -> Array:
        """Height of a part's lowest corner, per tick, m."""
        pose = self.poses[part]
        up = _third_rows(pose[:, 3:])
        return pose[:, 2] - np.abs(up) @ (np.array(self.cell["edges"][part]) / 2.0)

    def releases(self, part: str) -> Iterator[Release]:
        """Every time that the last robot let go of a part."""
        held, rest = self.partners(part)
        stands = np.any(list(rest.values()), axis=0) if rest else np.zeros_like(held)
        low, places = self.lowest(part), self.poses[part][:, :3]
        for last in np.flatnonzero(held[:-1] & ~held[1:]):
            if stands[last]:
                name = next(name for name, found in rest.items() if found[last])
                yield Release(self.times[last], 0.0, name, 0.0)
                continue
            falls = (np.arange(len(held)) > last) & (self.times < self.times[last] + FALL)
            later = np.flatnonzero(stands & falls)
            if len(later):
                first = later[0]
                name = next(name for name, found in rest.items() if found[first])
                passed = self.times[first - 1] - self.times[first - 2]
                speed = float(np.linalg.norm(places[first - 1] - places[first - 2]) / passed)
                yield Release(self.times[last], max(0.0, low[last] - low[first]), name, speed)

    def slip(self, part: str) -> float:
        """How far a part moved in a robot's grip at most while it touched nothing but robots, m."""
        worst = 0.0
        for tool in self.tools:
            held, rest = self.partners(part, tool.removesuffix("tool"))
            stands = np.any(list(rest.values()), axis=0) if rest else np.zeros_like(held)
            for begin, end in _runs(held):
                free = np.arange(begin, end)[~stands[begin:end]]
                if len(free) < 2:
                    continue
                inside = _inside(self.poses[tool][free], self.poses[part][free, :3])
                worst = max(worst, float(np.linalg.norm(inside - inside[0], axis=1).max()))
        return worst

    def drag(self, part: str, other: str) -> float:
        """How far a robot moved a part over what it lay on, m."""
        held, rest = self.partners(part)
        both = held & _bridged(rest.get(other, np.zeros_like(held)), self.times)
        way = 0.0
        for begin, end in _runs(both):
            points = self.poses[part][begin:end:5, :2]
            way += float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
        return way

    def speeds(self, name: str) -> Array:
        """How fast a thing was, over two ticks, m/s."""
        points = self.poses[name][:, :3]
        ways: Array = np.linalg.norm(points[2:] - points[:-2], axis=1)
        return ways / (self.times[2:] - self.times[:-2])

    def first_touch(self, first: str, second: str) -> float | None:
        """When two touch first, s."""
        found = np.flatnonzero(self.touches(first, second))
        return float(self.times[found[0]]) if len(found) else None

    def starts(self, name: str) -> Array:
        """When a thing begins to move after it stood, s."""
        moves = _bridged(self.speeds(name) > 0.01, self.times[1:-1], 0.1)
        return self.times[1:-1][1:][moves[1:] & ~moves[:-1]]


def aside(points: Array, path: Array) -> float:
    """The largest distance of points from a path through others, m."""
    points, path = points[::2], path[::2]
    start, way = path[:-1], np.diff(path, axis=0)
    length = np.maximum((way**2).sum(axis=1), 1e-18)
    worst = 0.0
    for point in points:
        share = np.clip(((point - start) * way).sum(axis=1) / length, 0.0, 1.0)
        gap = ((start + share[:, None] * way - point) ** 2).sum(axis=1).min()
        worst = max(worst, float(gap))
    return float(worst**0.5)


def turned_aside(turns: Array, known: Array) -> float:
    """The greatest angle of orientations from the nearest of others, deg."""
    nearest = np.abs(turns[::5] @ known.T).max(axis=1)
    return float(np.degrees(2.0 * np.arccos(min(1.0, float(nearest.min())))))


def angle(first: Array, second: Array) -> float:
    """Between two orientations, deg."""
    return float(np.degrees(2.0 * np.arccos(min(1.0, abs(float(first @ second))))))


def _bridged(found: Truth, times: Array, gap: float = FLICKER) -> Truth:
    """With interruptions shorter than ``gap`` (s) filled."""
    found = found.copy()
    for begin, end in _runs(~found):
        if begin and end < len(found) and times[end] - times[begin - 1] <= gap:
            found[begin:end] = True
    return found


def _runs(found: Truth) -> list[tuple[int, int]]:
    """From where to where it holds."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], found.astype(int), [0]))))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def _third_rows(turns: Array) -> Array:
    w, x, y, z = turns.T
    return np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)


def _inside(frames: Array, points: Array) -> Array:
    """Points in the frames of poses."""
    w, x, y, z = frames[:, 3:].T
    rows = np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=1),
        np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], axis=1),
        np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1),
    ], axis=1)  # fmt: skip
    found: Array = np.einsum("nji,nj->ni", rows, points - frames[:, :3])
    return found
