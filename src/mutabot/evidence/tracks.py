"""Tracks side by side: how far things were from where they are in the original, at the same time.

Paths of points are made simple before it is looked how far points lie beside one.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import acos, degrees, dist, inf, isnan, sqrt

from mutabot.frozen import frozen
from mutabot.model.outcome import Apart, Near

from .recording import Block, Kind, Recording, Track

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


#: differences that count as the same: m, degrees, and the share of a value's own range
LENGTH, ANGLE, SHARE = 0.001, 0.5, 0.01
#: what the name of an orientation ends with
TURNED = " turned"
#: by so much may one moment be told otherwise twice, s
_SAME = 1e-6
#: how much closer than in the original an approach must be to be told, m
_CLOSER = 0.005


@dataclass(frozen=True)
class Path:
    """Where one thing was over time.

    Attributes:
        track: its numbers.
        times: when, s.
    """

    track: Track
    times: Sequence[float]

    @cached_property
    def least(self) -> dict[Block, tuple[float, float]]:
        """Its least distances from blocks, m, and when, as far as anybody has asked."""
        return {}

    @cached_property
    def rows(self) -> list[tuple[float, ...]]:
        """The numbers of each moment at which it was there."""
        width = self.track.kind.width
        rows = list(zip(*[iter(self.track.values)] * width, strict=True))[: len(self.times)]
        return [row for row in rows if not isnan(row[0])] if self._is_away else rows

    @cached_property
    def when(self) -> Sequence[float]:
        """The moments at which it was there: the recording's own, if it always was."""
        if not self._is_away:
            return self.times
        width, values = self.track.kind.width, self.track.values
        return [time for number, time in enumerate(self.times) if not isnan(values[number * width])]

    @cached_property
    def _is_away(self) -> bool:
        """Whether there are moments at which it was not there."""
        return any(map(isnan, self.track.values[:: self.track.kind.width]))

    @cached_property
    def points(self) -> list[Point]:
        """Its positions, m."""
        return [(row[0], row[1], row[2]) for row in self.rows]

    @cached_property
    def outline(self) -> list[Point]:
        """The same with fewer points, to half of the tolerance."""
        return simple(self.points, LENGTH / 2)

    def at(self, time: float) -> int:
        """The number of the row that holds at a time: the last one before or at it, else the first."""
        return max(0, bisect_right(self.when, time + _SAME) - 1)


def paths_of(recording: Recording) -> dict[str, Path]:
    """Everything that was tracked, by name, if it was ever there."""
    found = {name: Path(track, recording.times) for name, track in recording.tracks.items()}
    return {name: path for name, path in found.items() if path.rows}


@dataclass(frozen=True)
class Seen:
    """A recording, and what is worked out of it once."""

    recording: Recording

    @cached_property
    def paths(self) -> dict[str, Path]:
        """Everything that was tracked."""
        return paths_of(self.recording)


def differences(
    original: dict[str, Path],
    mutant: dict[str, Path],
    noise: Mapping[str, float] | None = None,
    until: float = inf,
) -> list[Apart]:
    """What was apart by more than its tolerance, worst first.

    Args:
        noise: by how much each is apart in equal runs of the original.
        until: s from when on nothing is compared.
    """
    found = []
    together = _Together()
    for name in original.keys() & mutant.keys():
        before, after = original[name], mutant[name]
        if before.track.kind is not after.track.kind:
            continue
        moments = together.of(before, after)
        rows = [one for one in _differing(before, after, moments) if one[0] <= until]
        last = next((time for time, _, _ in reversed(moments) if time <= until), -inf)
        for measure in _measures(before) if rows else ():
            tolerance = max(measure.tolerance, 2.0 * (noise or {}).get(measure.name, 0.0))
            one = _apart(measure, before, after, rows, tolerance, last)
            if one is not None:
                found.append(one)
    return sorted(found, key=lambda one: (-one.worst, one.name))


def noise_of(one: dict[str, Path], other: dict[str, Path]) -> dict[str, float]:
    """By how much each thing is apart in two equal runs."""
    found = {}
    together = _Together()
    for name in one.keys() & other.keys():
        rows = _differing(one[name], other[name], together.of(one[name], other[name]))
        for measure in _measures(one[name]):
            gaps = (measure.between(before, after) for _, before, after in rows)
            found[measure.name] = max(gaps, default=0.0)
    return found


def approaches(original: dict[str, Path], mutant: dict[str, Path], blocks: Sequence[Block]) -> list[Near]:
    """Closest approaches that are closer than in the original, closest first."""
    found = []
    for name in original.keys() & mutant.keys():
        if original[name].track.kind is Kind.VALUE:
            continue
        if original[name].rows == mutant[name].rows:
            continue
        for block in blocks:
            least, at = _least(mutant[name], block)
            before, _ = _least(original[name], block)
            if least < before - _CLOSER:
                found.append(Near(name, block.name, least, at, before))
    return sorted(found, key=lambda one: (one.distance, one.body, one.obstacle))


@frozen
class _Measure:
    """One way to tell two rows apart."""

    name: str
    unit: str
    tolerance: float
    between: Callable[[Sequence[float], Sequence[float]], float]
    is_position: bool = False


def _measures(path: Path) -> Iterator[_Measure]:
    track = path.track
    if track.kind is Kind.VALUE:
        values = [row[0] for row in path.rows]
        tolerance = SHARE * (max(values) - min(values)) or 1e-6
        yield _Measure(track.name, track.unit, tolerance, lambda one, other: abs(one[0] - other[0]))
        return
    yield _Measure(track.name, "m", LENGTH, lambda one, other: dist(one[:3], other[:3]), True)
    if track.kind is Kind.POSE:
        yield _Measure(f"{track.name}{TURNED}", "deg", ANGLE, _turned)


def _turned(one: Sequence[float], other: Sequence[float]) -> float:
    """The angle between two orientations, deg."""
    dot = abs(sum(a * b for a, b in zip(one[3:7], other[3:7], strict=True)))
    return degrees(2.0 * acos(min(1.0, dot)))


#: a moment, and the numbers of the rows that hold then
_Moment = tuple[float, int, int]
#: a moment at which things are not the same, and how they are
_Differing = tuple[float, tuple[float, ...], tuple[float, ...]]


class _Together:
    """Moments of two recordings: things that are always there share them."""

    def __init__(self) -> None:
        self._known: dict[tuple[int, int], list[_Moment]] = {}

    def of(self, before: Path, after: Path) -> list[_Moment]:
        """Those of two paths, which both live as long as this."""
        key = id(before.when), id(after.when)
        if key not in self._known:
            self._known[key] = _together(before.when, after.when)
        return self._known[key]


def _differing(before: Path, after: Path, moments: Iterable[_Moment]) -> list[_Differing]:
    """What is not the same, at all moments of either; what has ended stays as it was."""
    rows, others = before.rows, after.rows
    return [
        (time, one, other) for time, here, there in moments if (one := rows[here]) != (other := others[there])
    ]


def _together(one: Sequence[float], other: Sequence[float]) -> list[_Moment]:
    """All moments of either, with the numbers of the rows that hold then, as ``Path.at`` has them."""
    if one == other:
        return [(time, number, number) for number, time in enumerate(one)]
    found = []
    here = there = 0
    last, end = len(one) - 1, len(other) - 1
    for time in sorted({*one, *other}):
        until = time + _SAME
        while here < last and one[here + 1] <= until:
            here += 1
        while there < end and other[there + 1] <= until:
            there += 1
        found.append((time, here, there))
    return found


def _apart(
    measure: _Measure,
    before: Path,
    after: Path,
    rows: Iterable[_Differing],
    tolerance: float,
    last: float,
) -> Apart | None:
    """How far apart things were, if by more than the tolerance; ``last`` is the last moment of all."""
    gaps = [(time, measure.between(one, other)) for time, one, other in rows]
    first = next((time for time, gap in gaps if gap > tolerance), None)
    if first is None:
        return None
    at, largest = max(gaps, key=lambda one: one[1])
    final = gaps[-1][1] if gaps[-1][0] == last else 0.0
    beside = _aside(measure, before, after)
    return Apart(measure.name, measure.unit, first, largest, at, final, beside, tolerance)


def _aside(measure: _Measure, before: Path, after: Path) -> float | None:
    """How far something went where it never is in the original."""
    if measure.is_position:
        return aside(after.outline, before.outline)
    if before.track.kind is not Kind.VALUE:
        return None
    usual = [row[0] for row in before.rows]
    least, most = min(usual), max(usual)
    return max(max(0.0, least - row[0], row[0] - most) for row in after.rows)


def _least(path: Path, block: Block) -> tuple[float, float]:
    """The least distance of a path from a block, m, and when."""
    known = path.least.get(block)
    if known is None:
        known = path.least[block] = _sought(path, block)
    return known


def _sought(path: Path, block: Block) -> tuple[float, float]:
    size, (x, y, z) = path.track.size or (0.0, 0.0, 0.0), block.centre
    dx, dy, dz = (0.5 * (one + other) for one, other in zip(size, block.size, strict=True))
    least, when = inf, 0.0
    for (px, py, pz), time in zip(path.points, path.when, strict=True):
        # written out: this is asked of every moment of every mutant
        gx, gy, gz = abs(px - x) - dx, abs(py - y) - dy, abs(pz - z) - dz
        square = (gx * gx if gx > 0 else 0.0) + (gy * gy if gy > 0 else 0.0) + (gz * gz if gz > 0 else 0.0)
        if square < least:
            least, when = square, time
    return float(least**0.5), when
