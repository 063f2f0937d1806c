"""Paths of recorded things over time, and the distance of points from a path.

Paths of points are simplified before the distance of points from a path is measured. Between two recorded
moments a path is not known: what is no farther from it than it may bow there has not left it.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import asin, degrees, dist, hypot, inf, isnan, sqrt
from typing import Self

from mutabot.evidence.recording import Recording, Track, TrackKind, bytes_of, from_bytes

Point = tuple[float, float, float]
#: a row of a track: the numbers of one moment
Row = tuple[float, ...]

#: a length that counts as none, m
LENGTH = 0.001
#: orientations of a run that are compared, and how near two quaternions are that count as one: 0.1 degrees
_MOST_TURNS, _SAME_TURN = 300, 0.0009
#: two times that differ by less are the same moment, s
_SAME = 1e-6
#: how far a path may be from a line, in what the points at its ends swerve: if the next ones do not, and how
#: much less if they do as well
_CORNER, _ARC = 1.25, 0.75
#: s: moments that lie closer together belong to two worlds
STEP = 0.02


def simple(points: Sequence[Point], tolerance: float) -> list[Point]:
    """Leave out points that lie within ``tolerance`` (m) of the lines between the others.

    Source: D. H. Douglas, T. K. Peucker: Algorithms for the reduction of the number of points required to
    represent a digitized line or its caricature. Cartographica 10 (1973), pp. 112-122.
    """
    return [points[number] for number in _kept(points, tolerance)]


def _kept(points: Sequence[Point], tolerance: float) -> list[int]:
    """Return the numbers of the points that ``simple`` keeps."""
    kept = {0, len(points) - 1}
    waiting = [(0, len(points) - 1)]
    while waiting:
        first, last = waiting.pop()
        segment = _segment(points[first], points[last])
        far, where = max(
            ((_square(points[number], segment), number) for number in range(first + 1, last)),
            default=(0.0, first),
        )
        if sqrt(far) > tolerance:
            kept.add(where)
            waiting += [(first, where), (where, last)]
    return sorted(kept)


def aside(points: Iterable[Point], path: Sequence[Point], bows: Sequence[float] = ()) -> float:
    """Return the largest distance of points from a path, m.

    ``bows``: how far the path may be from each of its lines, m; points that are no farther lie on it.
    """
    segments = [_segment(first, second) for first, second in pairwise(path)] or [_segment(path[0], path[0])]
    squares = [bow * bow for bow in bows] or [0.0] * len(segments)
    worst = 0.0
    for point in points:
        least = inf
        for segment, bow in zip(segments, squares, strict=True):
            far = _square(point, segment)
            least = min(least, far if far > bow else 0.0)
            if least <= worst:  # this point cannot be the farthest
                break
        worst = max(worst, least)
    return sqrt(worst)


def turned_aside(rows: Sequence[Row], path: Sequence[Row]) -> float:
    """Return the greatest angle (deg) of orientations from those on a path, also between its moments.

    What turns to and fro from one moment to the next, as a part that lands does, may have turned as far
    between them: that much is no difference.

    Unit quaternions at the angle a lie 2 sin(a / 4) apart, and those between two moments near their chord.
    """
    chords = _chords(_turns(path))
    worst = 0.0
    for turn in _without_repetitions(_turns(rows)):
        least, opposite = inf, [-part for part in turn]
        for chord, unseen in chords:
            square = min(_square_turned(turn, chord), _square_turned(opposite, chord))
            least = min(least, sqrt(square) - unseen)
            if least <= worst:
                break
        worst = max(worst, least)
    return degrees(4.0 * asin(min(1.0, worst / 2.0)))


def _turns(rows: Sequence[Row]) -> list[list[float]]:
    """Return the quaternions, each with the sign nearer to its predecessor."""
    found: list[list[float]] = []
    for row in rows[:: len(rows) // _MOST_TURNS + 1]:
        turn = list(row[3:7])
        if found and sum(a * b for a, b in zip(turn, found[-1], strict=True)) < 0.0:
            turn = [-part for part in turn]
        found.append(turn)
    return found


def _without_repetitions(turns: Sequence[list[float]]) -> list[list[float]]:
    found: list[list[float]] = []
    for turn in turns:
        if not found or dist(turn, found[-1]) > _SAME_TURN:
            found.append(turn)
    return found


def _chords(turns: Sequence[list[float]]) -> list[tuple[tuple[float, ...], float]]:
    """Return the chords between moments, each with how far the path may have been from it."""
    inner = (_strayed(*three) for three in zip(turns[1:], turns, turns[2:], strict=False))
    strayed = [0.0, *inner, 0.0]
    found = [
        (_chord(start, end), max(strayed[number : number + 2]))
        for number, (start, end) in enumerate(pairwise(turns))
        if dist(start, end) > _SAME_TURN
    ]
    return found or [(_chord(turns[0], turns[-1]), 0.0)]


def _strayed(turn: Sequence[float], start: Sequence[float], end: Sequence[float]) -> float:
    """Return how far an orientation is from the shortest turn between two others."""
    along = [b - a for a, b in zip(start, end, strict=True)]
    length = sum(part * part for part in along)
    way = sum((c - a) * part for a, c, part in zip(start, turn, along, strict=True))
    share = min(1.0, max(0.0, way / length)) if length else 0.0
    foot = [a + share * part for a, part in zip(start, along, strict=True)]
    size = hypot(*foot)
    return dist(turn, [part / size for part in foot]) if size else 0.0


def _chord(start: Sequence[float], end: Sequence[float]) -> tuple[float, ...]:
    """Return the start of a chord between two quaternions, its direction, and the square of its length."""
    along = [b - a for a, b in zip(start, end, strict=True)]
    return (*start, *along, sum(part * part for part in along))


def _square_turned(turn: Sequence[float], chord: tuple[float, ...]) -> float:
    """Return the square of a quaternion's distance from a chord, inlined, as every mutant needs many."""
    aw, ax, ay, az, dw, dx, dy, dz, length = chord
    w, x, y, z = turn[0] - aw, turn[1] - ax, turn[2] - ay, turn[3] - az
    share = (w * dw + x * dx + y * dy + z * dz) / length if length else 0.0
    share = 0.0 if share < 0.0 else 1.0 if share > 1.0 else share
    w, x, y, z = w - share * dw, x - share * dx, y - share * dy, z - share * dz
    return w * w + x * x + y * y + z * z


def _segment(start: Point, end: Point) -> tuple[float, ...]:
    """Return the start of a segment, its direction, and the square of its length."""
    x, y, z = start
    dx, dy, dz = end[0] - x, end[1] - y, end[2] - z
    return x, y, z, dx, dy, dz, dx * dx + dy * dy + dz * dz


def _square(point: Point, segment: tuple[float, ...]) -> float:
    """Return the square of a point's distance from a segment, inlined, as every mutant needs many."""
    ax, ay, az, dx, dy, dz, length = segment
    x, y, z = point[0] - ax, point[1] - ay, point[2] - az
    share = (x * dx + y * dy + z * dz) / length if length else 0.0
    share = 0.0 if share < 0.0 else 1.0 if share > 1.0 else share
    x, y, z = x - share * dx, y - share * dy, z - share * dz
    return x * x + y * y + z * z


@dataclass(frozen=True)
class TrackPath:
    """The path of one thing over time.

    Attributes:
        track: its numbers.
        times: the times of its rows, s.
    """

    track: Track
    times: Sequence[float]

    @cached_property
    def _present(self) -> list[tuple[float, Row]]:
        """The moments at which the thing existed, with their numbers."""
        values = [iter(self.track.values)] * self.track.width
        rows = zip(self.times, zip(*values, strict=True), strict=False)
        if self.track.kind is TrackKind.LINE:  # each of its points may be missing
            return [(time, row) for time, row in rows if not any(map(isnan, row))]
        return [(time, row) for time, row in rows if not isnan(row[0])]

    @cached_property
    def rows(self) -> list[Row]:
        """The numbers of each moment at which the thing existed."""
        return [row for _, row in self._present]

    @cached_property
    def when(self) -> Sequence[float]:
        """The moments at which the thing existed."""
        return [time for time, _ in self._present]

    @cached_property
    def points(self) -> list[Point]:
        """The positions, m."""
        return [(row[0], row[1], row[2]) for row in self.rows]

    @cached_property
    def outline(self) -> list[Point]:
        """The path with fewer points, within half of the tolerance."""
        return [self.points[number] for number in self._corners]

    @cached_property
    def bows(self) -> list[float]:
        """The distance (m) it may have had from each line of its outline between the moments of its rows."""
        swerves = [0.0, *(self._swerve(number) for number in range(len(self.points))), 0.0]
        beside = zip(swerves, swerves[1:], swerves[2:], swerves[3:], strict=False)
        bends = [
            _CORNER * max(first, second) - _ARC * min(before, after)
            for before, first, second, after in beside
        ]
        return [max(0.0, *bends[first:last]) for first, last in pairwise(self._corners)]

    @cached_property
    def _corners(self) -> list[int]:
        return _kept(self.points, LENGTH / 2)

    def _swerve(self, number: int) -> float:
        """Return how far a point is from the line between its neighbours, m.

        On an arc that is four times as far as the path is from the line between two moments, and so are the
        points next to these. At a corner between two moments it is nearly as far as the corner, and those
        are not.
        """
        if not 0 < number < len(self.points) - 1:
            return 0.0
        before, now, after = self.when[number - 1 : number + 2]
        previous, point, following = self.points[number - 1 : number + 2]
        if min(now - before, after - now) <= STEP:  # another world begins
            return 0.0
        return sqrt(_square(point, _segment(previous, following)))

    def at(self, time: float) -> int:
        """Return the number of the row that holds at a time: the last one before or at it, else the first."""
        return max(0, bisect_right(self.when, time + _SAME) - 1)


@dataclass(frozen=True, eq=False)
class RecordedPaths:
    """The recording of one test, with the paths of tracked things, computed once."""

    recording: Recording

    @classmethod
    def from_text(cls, text: str) -> Self:
        """Read what a test reports as its recording. Raises ValueError for anything else."""
        return cls(from_bytes(bytes_of(text)))

    @cached_property
    def paths(self) -> dict[str, TrackPath]:
        """The paths that are compared, by name, of things that existed; times in s, positions in m."""
        return self._those(is_drawn=False)

    @cached_property
    def lines(self) -> dict[str, TrackPath]:
        """The lines that are only drawn, by name; three numbers for each point."""
        return self._those(is_drawn=True)

    def _those(self, *, is_drawn: bool) -> dict[str, TrackPath]:
        times, tracks = self.recording.times, self.recording.tracks.items()
        found = {
            name: TrackPath(track, times)
            for name, track in tracks
            if (track.kind is TrackKind.LINE) is is_drawn
        }
        return {name: path for name, path in found.items() if path.rows}
