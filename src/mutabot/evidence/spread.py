"""The original's own spread: how far its runs with different seeds are apart in one test.

A seed may also decide what there is to do, such as whether a box is red or blue, and so where it belongs.
Only runs that did the same are compared, if any two did.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from math import dist
from typing import TYPE_CHECKING, Any

from mutabot.evidence.calls import what_was_done
from mutabot.evidence.contacts import intervals_of
from mutabot.evidence.differences import Measure, Spread, aside_of, measures_of
from mutabot.evidence.physics import facts_of
from mutabot.evidence.recording import TrackKind
from mutabot.model.deviation import spread_of

if TYPE_CHECKING:
    from mutabot.evidence.paths import RecordedPaths, Row, TrackPath

#: m: a test in which the original ends farther apart than this has no stable end
_STABLE = 0.1


def spread_between(runs: Sequence[RecordedPaths]) -> Spread:
    """Return how far runs of the original with different seeds are apart in one test."""
    if not runs:
        return Spread()
    ends: dict[str, float] = {}
    paths: dict[str, float] = {}
    alike = _alike(runs)
    pairs = [pair for those in alike for pair in combinations(those, 2)]
    for first, second in pairs:
        for name in first.paths.keys() & second.paths.keys():
            before, after = first.paths[name], second.paths[name]
            for measure in measures_of(before) if before.track.kind is after.track.kind else ():
                far = _end_distance(measure, before, after)
                ends[measure.name] = max(far, ends.get(measure.name, 0.0))
                both_ways = ((before, after), (after, before))
                beside = (aside_of(measure, *one_way) or 0.0 for one_way in both_ways)
                paths[measure.name] = max(*beside, paths.get(measure.name, 0.0))
    touched = [intervals_of(run.recording).keys() for run in runs]
    return Spread(
        ends,
        paths,
        _measured(alike),
        frozenset().union(*touched),
        frozenset(touched[0]).intersection(*touched[1:]),
        _scatters(runs, ends),
    )


def _alike(runs: Sequence[RecordedPaths]) -> list[list[RecordedPaths]]:
    """Return the runs grouped by what was done in them; as one group if no two did the same."""
    found: dict[frozenset[Any], list[RecordedPaths]] = {}
    for run in runs:
        calls = (((call.place, call.operation, call.pattern), call.read) for call in run.recording.calls)
        found.setdefault(what_was_done(calls), []).append(run)
    return [*found.values()] if len(found) < len(runs) else [[*runs]]


def _end_distance(measure: Measure, before: TrackPath, after: TrackPath) -> float:
    """Return how far apart a thing ends; if each seed places it elsewhere, by how far it has moved since."""
    apart = measure.between(before.rows[-1], after.rows[-1])
    return min(apart, dist(_moved(before), _moved(after))) if measure.unit == "m" else apart


def _moved(path: TrackPath) -> Row:
    return tuple(end - start for start, end in zip(path.rows[0][:3], path.rows[-1][:3], strict=True))


def _measured(alike: Sequence[Sequence[RecordedPaths]]) -> dict[tuple[str, str], float]:
    found: dict[tuple[str, str], float] = {}
    for runs in alike:
        values: dict[tuple[str, str], list[float]] = {}
        for run in runs:
            for key, fact in facts_of(run).items():
                values.setdefault(key, []).append(fact.value)
        found |= {key: max(spread_of(those), found.get(key, 0.0)) for key, those in values.items()}
    return found


def _scatters(runs: Sequence[RecordedPaths], ends: dict[str, float]) -> str:
    """Describe the thing whose end is least stable."""
    kinds = {name: path.track.kind for run in runs for name, path in run.paths.items()}
    places = (name for name, kind in kinds.items() if kind is not TrackKind.VALUE and name in ends)
    far, name = max(((ends[name], name) for name in places), default=(0.0, ""))
    return f"{name} by {far:.2g} m" if far > _STABLE else ""
