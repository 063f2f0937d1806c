"""Compare recordings: how far things were from their places in the original run at the same time, in words.

Paths of points are simplified before the distance of points from a path is measured. The sentence tells of
contacts first, where a simulator reports them; then how far things left their paths, and where they ended.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import acos, degrees, dist, inf, isclose, isnan, sqrt
from typing import Any, NamedTuple

from mutabot.evidence.recording import RecordedCall, Recording, Track, TrackKind
from mutabot.model.outcome import Apart, Diverged
from mutabot.model.quantity import distinct_texts, is_number, value_text

Point = tuple[float, float, float]
#: a row of a track: the numbers of one moment
Row = tuple[float, ...]

#: differences that count as the same: m, degrees, and the share of a value's own range
LENGTH, ANGLE, SHARE = 0.001, 0.5, 0.01
#: what the name of an orientation ends with
TURNED = " turned"
#: two times that differ by less are the same moment, s
_SAME = 1e-6


def simple(points: Sequence[Point], tolerance: float) -> list[Point]:
    """Leave out points that lie within ``tolerance`` (m) of the lines between the others.

    Source: D. H. Douglas, T. K. Peucker: Algorithms for the reduction of the number of points required to
    represent a digitized line or its caricature. Cartographica 10 (1973), pp. 112-122.
    """
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
    return [points[number] for number in sorted(kept)]


def aside(points: Iterable[Point], path: Sequence[Point]) -> float:
    """Return the largest distance of points from a path, m."""
    segments = [_segment(one, other) for one, other in pairwise(path)] or [_segment(path[0], path[0])]
    worst = 0.0
    for point in points:
        least = inf
        for segment in segments:
            least = min(least, _square(point, segment))
            if least <= worst:  # this point cannot be the farthest
                break
        worst = max(worst, least)
    return sqrt(worst)


def _segment(one: Point, other: Point) -> tuple[float, ...]:
    """A line's start, its direction, and the square of its length."""
    x, y, z = one
    dx, dy, dz = other[0] - x, other[1] - y, other[2] - z
    return x, y, z, dx, dy, dz, dx * dx + dy * dy + dz * dz


def _square(point: Point, segment: tuple[float, ...]) -> float:
    """The square of a point's distance from a segment, written out: many are asked of every mutant."""
    ax, ay, az, dx, dy, dz, length = segment
    x, y, z = point[0] - ax, point[1] - ay, point[2] - az
    share = (x * dx + y * dy + z * dz) / length if length else 0.0
    share = 0.0 if share < 0.0 else 1.0 if share > 1.0 else share
    x, y, z = x - share * dx, y - share * dy, z - share * dz
    return x * x + y * y + z * z


@dataclass(frozen=True)
class TrackPath:
    """Where one thing was over time.

    Attributes:
        track: its numbers.
        times: the times of its rows, s.
    """

    track: Track
    times: Sequence[float]

    @cached_property
    def _present(self) -> list[tuple[float, Row]]:
        """The moments at which it was there, with their numbers."""
        values = [iter(self.track.values)] * self.track.kind.width
        rows = zip(self.times, zip(*values, strict=True), strict=False)
        return [(time, row) for time, row in rows if not isnan(row[0])]

    @cached_property
    def rows(self) -> list[Row]:
        """The numbers of each moment at which it was there."""
        return [row for _, row in self._present]

    @cached_property
    def when(self) -> Sequence[float]:
        """The moments at which it was there."""
        return [time for time, _ in self._present]

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


def paths_of(recording: Recording) -> dict[str, TrackPath]:
    """Everything that was tracked, by name, if it was ever there."""
    found = {name: TrackPath(track, recording.times) for name, track in recording.tracks.items()}
    return {name: path for name, path in found.items() if path.rows}


@dataclass(frozen=True)
class RecordedPaths:
    """A recording, and its paths, which are worked out once."""

    recording: Recording

    @cached_property
    def paths(self) -> dict[str, TrackPath]:
        """Everything that was tracked."""
        return paths_of(self.recording)


class _Measure(NamedTuple):
    """One way to tell two rows apart."""

    name: str
    unit: str
    tolerance: float
    between: Callable[[Row, Row], float]


def _measures(path: TrackPath) -> Iterator[_Measure]:
    track = path.track
    if track.kind is TrackKind.VALUE:
        values = [row[0] for row in path.rows]
        tolerance = SHARE * (max(values) - min(values)) or 1e-6
        yield _Measure(track.name, track.unit, tolerance, lambda one, other: abs(one[0] - other[0]))
        return
    yield _Measure(track.name, "m", LENGTH, lambda one, other: dist(one[:3], other[:3]))
    if track.kind is TrackKind.POSE:
        yield _Measure(f"{track.name}{TURNED}", "deg", ANGLE, _turned)


def _turned(one: Row, other: Row) -> float:
    """The angle between two orientations, deg."""
    dot = abs(sum(a * b for a, b in zip(one[3:7], other[3:7], strict=True)))
    return degrees(2.0 * acos(min(1.0, dot)))


def differences(
    original: dict[str, TrackPath],
    mutant: dict[str, TrackPath],
    noise: Mapping[str, float],
    until: float = inf,
) -> list[Apart]:
    """Return what was apart by more than its tolerance, worst first.

    Args:
        noise: by how much each thing is apart in equal runs of the original.
        until: the last time that is compared, s.
    """
    found = []
    for name in original.keys() & mutant.keys():
        before, after = original[name], mutant[name]
        if before.track.kind is not after.track.kind:
            continue
        rows = [(time, one, other) for time, one, other in _together(before, after) if time <= until]
        if any(one != other for _, one, other in rows):
            apart = (_apart(measure, before, after, rows, noise) for measure in _measures(before))
            found += [one for one in apart if one is not None]
    return sorted(found, key=lambda one: (-one.worst, one.name))


def noise_between(one: RecordedPaths, other: RecordedPaths) -> dict[str, float]:
    """Return by how much each thing is apart in two equal runs of the original."""
    found = {}
    for name in one.paths.keys() & other.paths.keys():
        rows = list(_together(one.paths[name], other.paths[name]))
        for measure in _measures(one.paths[name]):
            gaps = (measure.between(first, second) for _, first, second in rows if first != second)
            found[measure.name] = max(gaps, default=0.0)
    return found


def _together(before: TrackPath, after: TrackPath) -> Iterator[tuple[float, Row, Row]]:
    """The rows of both that hold at each moment of either; what has ended stays as it was."""
    if before.when == after.when:
        yield from zip(before.when, before.rows, after.rows, strict=True)
        return
    for time in sorted({*before.when, *after.when}):
        yield time, before.rows[before.at(time)], after.rows[after.at(time)]


def _apart(
    measure: _Measure,
    before: TrackPath,
    after: TrackPath,
    rows: Sequence[tuple[float, Row, Row]],
    noise: Mapping[str, float],
) -> Apart | None:
    """How far apart a thing was, if by more than the tolerance."""
    tolerance = max(measure.tolerance, 2.0 * noise.get(measure.name, 0.0))
    gaps = [(time, measure.between(one, other) if one != other else 0.0) for time, one, other in rows]
    first = next((time for time, gap in gaps if gap > tolerance), None)
    if first is None:
        return None
    at, largest = max(gaps, key=lambda one: one[1])
    beside = _aside(measure, before, after)
    return Apart(measure.name, measure.unit, first, largest, at, gaps[-1][1], beside, tolerance)


def _aside(measure: _Measure, before: TrackPath, after: TrackPath) -> float | None:
    """How far something left the path or range that it has in the original; None for orientations."""
    if before.track.kind is TrackKind.VALUE:
        usual = [row[0] for row in before.rows]
        least, most = min(usual), max(usual)
        return max(max(0.0, least - row[0], row[0] - most) for row in after.rows)
    return None if measure.name.endswith(TURNED) else aside(after.outline, before.outline)


#: parts of a sentence, and differences that are kept
_MOST_PARTS, _MOST = 3, 8
#: s by which two things must separate earlier than in the original, and by which a test must end earlier
_EARLIER, _EARLY = 0.3, 1.0
#: numbers of calls that differ by less are equal
_ROUNDING = 1e-6


def diverged(
    test: str,
    original: RecordedPaths,
    mutant: RecordedPaths,
    noise: Mapping[str, float] | None = None,
    *,
    is_cut: bool = False,
) -> Diverged | None:
    """Return how a mutant's test differs from the original's; None if nothing recorded differs.

    Args:
        test: node id.
        noise: by how much each thing is apart in equal runs of the original.
        is_cut: whether something ended the mutant's test before its end.
    """
    end = mutant.recording.times[-1] if is_cut and mutant.recording.times else inf
    apart = differences(original.paths, mutant.paths, noise or {}, end)
    found = [(one.first, f"{one.name} is at a different position than in the original run") for one in apart]
    call = _first_call(original.recording.calls, mutant.recording.calls)
    if call is not None and call[1] is not None:
        found.append((call[1], call[0]))
    if not found and call is None:
        return None
    at, what = min(found) if found else (None, "")
    if call is not None and call[1] is None:  # without a clock calls are all that has an order
        what = call[0]
    return Diverged(
        test=test,
        at=at,
        what=what,
        story=_story(original, mutant, apart, is_cut=is_cut),
        apart=tuple(apart[:_MOST]),
        fault=mutant.recording.fault,
        is_simulated=mutant.recording.is_simulated and original.recording.is_simulated,
    )


def _story(original: RecordedPaths, mutant: RecordedPaths, apart: Sequence[Apart], *, is_cut: bool) -> str:
    """The sentence, most important part first; empty if the world was the same."""
    usual, contacts = contacts_in(original.recording), contacts_in(mutant.recording)
    end, due = (one.recording.times[-1] if one.recording.times else 0.0 for one in (mutant, original))
    is_cut = is_cut and end < due - _EARLY
    parts = [f"the test ended at {end:.1f} s instead of {due:.1f} s"] if is_cut else []
    parts += _contacts(usual, contacts, mutant, end)
    parts += [part for one in apart if not one.is_delay and (part := _strayed(one, is_whole=not is_cut))]
    if not parts and apart:
        parts = ["the same movements happened at other times"]
    return "; ".join(list(dict.fromkeys(parts))[:_MOST_PARTS])


#: two bodies that touch each other, sorted
_BodyPair = tuple[str, ...]


def contacts_in(recording: Recording) -> dict[_BodyPair, tuple[float, float | None]]:
    """When two bodies touched first, and when they separated for good; None if they touch at the end."""
    found: dict[_BodyPair, tuple[float, float | None]] = {}
    for one in recording.moments:
        pair = tuple(one.text.split(", ", 1))
        if one.what == "touch":
            found[pair] = (found[pair][0] if pair in found else one.time, None)
        elif one.what == "part" and pair in found:
            found[pair] = (found[pair][0], one.time)
    return found


def _contacts(
    usual: Mapping[_BodyPair, tuple[float, float | None]],
    contacts: Mapping[_BodyPair, tuple[float, float | None]],
    mutant: RecordedPaths,
    end: float,
) -> Iterator[str]:
    """What never touched, what separated at another time, and what touched in the mutant alone."""
    for pair in sorted(usual.keys() - contacts.keys()):
        if usual[pair][0] < end:
            yield f"{pair[0]} and {pair[1]} never touched (original: at {usual[pair][0]:.1f} s)"
    for pair in sorted(usual.keys() & contacts.keys()):
        due, apart = usual[pair][1], contacts[pair][1]
        if not _is_held(pair, mutant):
            continue
        if apart is None and due is not None and due < end:
            yield f"{pair[0]} and {pair[1]} never separated (original: at {due:.1f} s)"
        elif apart is not None and apart < (inf if due is None else due) - _EARLIER:
            original = "never" if due is None else f"at {due:.1f} s"
            yield f"{pair[0]} and {pair[1]} separated at {apart:.1f} s (original: {original})"
    for pair in sorted(contacts.keys() - usual.keys(), key=lambda one: contacts[one]):
        yield f"{pair[0]} touched {pair[1]} at {contacts[pair][0]:.1f} s"


def _is_held(pair: _BodyPair, seen: RecordedPaths) -> bool:
    """Whether one of the two is tracked and the other neither stands still nor is tracked."""
    fixed = {block.name for block in seen.recording.blocks}
    return len(seen.paths.keys() & set(pair)) == 1 and fixed.isdisjoint(pair)


def _strayed(one: Apart, *, is_whole: bool) -> str:
    """How far one thing was from its path, and where it ended; empty if by no more than its tolerance."""
    strayed, final = one.aside or 0.0, one.final if is_whole else 0.0
    left = f"{one.name} left its path by up to {amount(strayed)}"
    if final > one.tolerance:
        thing = one.name.removesuffix(TURNED)
        if thing != one.name:
            return f"{thing} ended turned by {amount(final, one.unit)}"
        if one.unit != "m":
            return f"{one.name} ended {amount(final, one.unit)} from its value in the original"
        if strayed > 2.0 * final:
            return f"{left} and ended {amount(final)} from its original position"
        return f"{one.name} ended {amount(final)} from its position in the original"
    if strayed <= one.tolerance or one.unit != "m":
        return ""
    return f"{left}{' but reached the correct end position' if is_whole else ''}"


def amount(value: float, unit: str = "m") -> str:
    """``40 mm``, ``0.31 m``, ``12 deg``."""
    if unit == "m" and value < 0.1:
        millimetres = 1e3 * value if value >= 1e-4 else 0.0
        return f"{millimetres:.0f} mm" if millimetres >= 10.0 else f"{millimetres:.2g} mm"
    return f"{value:.3g} {unit}".strip()


def _first_call(
    original: Sequence[RecordedCall], mutant: Sequence[RecordedCall]
) -> tuple[str, float | None] | None:
    """The first call that differs, in words, and when it began; None if all calls are the same."""
    for one, other in zip(original, mutant, strict=False):
        found = _difference(one, other)
        if found:
            return found, other.began
    if len(mutant) < len(original):
        one = original[len(mutant)]
        return f"{_name(one)} is no longer called", one.began
    if len(original) < len(mutant):
        other = mutant[len(original)]
        return f"{_name(other)} is called once more", other.began
    return None


def _difference(one: RecordedCall, other: RecordedCall) -> str:
    """How a call differs from the original's; empty if it does not."""
    if (one.operation, one.place, one.pattern) != (other.operation, other.place, other.pattern):
        return f"{_name(other)} is called instead of {_name(one)}"
    for before, after, verb in ((one.written, other.written, "sends"), (one.read, other.read, "reads")):
        for name in {**before, **after}:
            if not _are_equal(before.get(name), after.get(name)):
                usual, found = distinct_texts(before.get(name), after.get(name), value_text, 4)
                return f"{_name(other)} {verb} {name} {found} instead of {usual}"
    return ""


def _are_equal(value: Any, other: Any) -> bool:
    """Whether values are equal, numbers up to rounding."""
    if isinstance(value, Mapping) and isinstance(other, Mapping):
        return value.keys() == other.keys() and all(_are_equal(value[key], other[key]) for key in value)
    if isinstance(value, list | tuple) and isinstance(other, list | tuple):
        return len(value) == len(other) and all(map(_are_equal, value, other))
    if is_number(value) and is_number(other):
        return isclose(value, other, rel_tol=_ROUNDING, abs_tol=_ROUNDING)
    return bool(value == other)


def _name(call: RecordedCall) -> str:
    return f"{call.place} {call.operation.rpartition(':')[2]}"
