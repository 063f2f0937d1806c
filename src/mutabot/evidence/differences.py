"""Compare recordings: how far things were from their places in the original run at the same time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field
from math import acos, degrees, dist, inf
from typing import NamedTuple

from mutabot.evidence.paths import LENGTH, RecordedPaths, Row, TrackPath, aside, turned_aside
from mutabot.evidence.recording import TrackKind
from mutabot.frozen import frozen
from mutabot.model.deviation import TOLERANCES, TURNS, difference_of
from mutabot.model.world_difference import Apart

#: two bodies that touch each other, sorted
BodyPair = tuple[str, ...]
#: the share that counts as the same: of a value's own range, and at least of what counts as none in its unit
SHARE = 0.01
#: the same of a value without a known unit
_LEAST = 1e-6
#: what the name of an orientation ends with
TURNED = " turned"


class Measure(NamedTuple):
    """A measure of the difference between two rows.

    Attributes:
        name: of what, such as ``box turned``.
        unit: of the difference.
        tolerance: difference up to which two rows count as the same.
        between: the difference of two rows.
    """

    name: str
    unit: str
    tolerance: float
    between: Callable[[Row, Row], float]


def measures_of(path: TrackPath) -> Iterator[Measure]:
    """Yield the measures for a thing: of its position and orientation, or of its value."""
    track = path.track
    if track.kind is TrackKind.VALUE:
        values = [row[0] for row in path.rows]
        least = SHARE * TOLERANCES[track.unit] if track.unit in TOLERANCES else _LEAST
        tolerance = max(SHARE * (max(values) - min(values)), least)  # what does not move trembles in a solver
        yield Measure(
            track.name,
            track.unit,
            tolerance,
            lambda first, second: difference_of(first[0], second[0], track.unit),
        )
        return
    yield Measure(track.name, "m", LENGTH, lambda first, second: dist(first[:3], second[:3]))
    if track.kind is TrackKind.POSE:
        yield Measure(f"{track.name}{TURNED}", "deg", TOLERANCES["deg"], turned)


def turned(first: Row, second: Row) -> float:
    """Return the angle between two orientations, deg."""
    dot = abs(sum(a * b for a, b in zip(first[3:7], second[3:7], strict=True)))
    return degrees(2.0 * acos(min(1.0, dot)))


@frozen
class Spread:
    """How far runs of the original with different seeds are apart in one test.

    Attributes:
        ends: by how much each thing is apart at the end, by name of the measure.
        paths: how far it leaves the paths or ranges of the other runs, likewise.
        measured: by how much each measurement differs, by name and thing.
        ever: pairs of bodies that touch each other in any run.
        always: those that do so in each; None if no run is known.
        scatters: what ends far apart, such as ``box by 0.52 m``; empty if the end of the test is stable.
    """

    ends: Mapping[str, float] = field(default_factory=dict)
    paths: Mapping[str, float] = field(default_factory=dict)
    measured: Mapping[tuple[str, str], float] = field(default_factory=dict)
    ever: frozenset[BodyPair] = frozenset()
    always: frozenset[BodyPair] | None = None
    scatters: str = ""


def differences(
    original: dict[str, TrackPath],
    mutant: dict[str, TrackPath],
    noise: Mapping[str, float],
    spread: Spread,
    until: float = inf,
) -> list[Apart]:
    """Return the things that were apart by more than their tolerance, largest deviation first.

    Args:
        noise: by how much each thing is apart in equal runs of the original.
        spread: by how much each thing is apart in runs of the original with different seeds.
        until: the last time that is compared, s.
    """
    found = []
    for name in original.keys() & mutant.keys():
        before, after = original[name], mutant[name]
        if before.track.kind is not after.track.kind:
            continue
        rows = [(time, first, second) for time, first, second in _paired_rows(before, after) if time <= until]
        if any(first != second for _, first, second in rows):
            apart = (_apart(measure, before, after, rows, noise, spread) for measure in measures_of(before))
            found += [deviation for deviation in apart if deviation is not None]
    return sorted(found, key=lambda deviation: (-deviation.deviation, deviation.name))


def noise_between(left: RecordedPaths, right: RecordedPaths) -> dict[str, float]:
    """Return by how much each thing differs between two equal runs of the original."""
    found = {}
    for name in left.paths.keys() & right.paths.keys():
        rows = list(_paired_rows(left.paths[name], right.paths[name]))
        for measure in measures_of(left.paths[name]):
            gaps = (measure.between(first, second) for _, first, second in rows if first != second)
            found[measure.name] = max(gaps, default=0.0)
    return found


def _paired_rows(before: TrackPath, after: TrackPath) -> Iterator[tuple[float, Row, Row]]:
    """Yield each moment of either run with the rows of both; the last row of an ended run holds."""
    if before.when == after.when:
        yield from zip(before.when, before.rows, after.rows, strict=True)
        return
    for time in sorted({*before.when, *after.when}):
        yield time, before.rows[before.at(time)], after.rows[after.at(time)]


def _apart(
    measure: Measure,
    before: TrackPath,
    after: TrackPath,
    rows: Sequence[tuple[float, Row, Row]],
    noise: Mapping[str, float],
    spread: Spread,
) -> Apart | None:
    """Return how far apart a thing was; None if within the tolerance."""
    tolerance = max(measure.tolerance, 2.0 * noise.get(measure.name, 0.0))
    gaps = [(time, measure.between(left, right) if left != right else 0.0) for time, left, right in rows]
    first = next((time for time, gap in gaps if gap > tolerance), None)
    if first is None:
        return None
    at, largest = max(gaps, key=lambda gap: gap[1])
    name, beside = measure.name, aside_of(measure, before, after)
    spreads = spread.ends.get(name, 0.0), spread.paths.get(name, 0.0)
    is_value = before.track.kind is TrackKind.VALUE
    return Apart(
        name, measure.unit, first, largest, at, gaps[-1][1], beside, tolerance, *spreads, is_value=is_value
    )


def aside_of(measure: Measure, before: TrackPath, after: TrackPath) -> float | None:
    """Return how far a value left the path, orientations or range that it has in the original.

    None for angles that are values: in which range they are depends on how full turns are counted.
    """
    if measure.name.endswith(TURNED):
        return turned_aside(after.rows, before.rows)
    if measure.unit in TURNS:
        return None
    if before.track.kind is TrackKind.VALUE:
        usual = [row[0] for row in before.rows]
        least, most = min(usual), max(usual)
        return max(max(0.0, least - row[0], row[0] - most) for row in after.rows)
    return aside(after.outline, before.outline, before.bows)
