"""The data of one mutant's page: how it ended, and what was recorded of it; of originals the latter.

Tracks have fewer points: what a straight line in time keeps within half a millimetre is left out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import accumulate, groupby, pairwise
from math import inf
from typing import Any

from mutabot.evidence.recording import Recording, Told, Track, TrackKind
from mutabot.evidence.tracks import TrackPath
from mutabot.model.quantity import value_text
from mutabot.report.document import data_of
from mutabot.report.texts import mapped
from mutabot.results.divergence import worst_of
from mutabot.results.results import MutantResult
from mutabot.results.stored import StoredEvidence

#: what one step of the whole numbers is, and by how many steps a line may miss: m; quaternions without unit
_LENGTH, _TURN = 1e-4, 1e-3
_MISS_LENGTH, _MISS_TURN = 5.0, 3.0
#: steps over the range of a value, and by how many a line may miss
_STEPS, _MISS_VALUE = 2000, 8.0

Row = tuple[float, ...]


def thinned(track: Track, times: Sequence[float]) -> Any:
    """A track as data: times in ms and numbers in steps, each as the difference from the one before."""
    path = TrackPath(track, times)
    when = path.when
    if not when:
        return None
    rows = list(accumulate(path.rows, _turned_like)) if track.kind is TrackKind.POSE else path.rows
    gaps = _gaps(times, when)
    scales, misses = _scales(track.kind, rows)
    steps = [tuple(value / scale for value, scale in zip(row, scales, strict=True)) for row in rows]
    kept = kept_points(when, steps, misses)
    channels = [[round(steps[index][axis]) for index in kept] for axis in range(len(scales))]
    return {
        "name": track.name,
        "kind": track.kind.value,
        "unit": track.unit,
        **({"size": list(track.size)} if track.size is not None else {}),
        **({"gaps": gaps} if gaps else {}),
        "scales": scales,
        "t": _differences([round(1000 * when[index]) for index in kept]),
        "v": [_differences(channel) for channel in channels],
    }


def kept_points(times: Sequence[float], rows: Sequence[Row], misses: Sequence[float]) -> list[int]:
    """Return the points to keep: on a line between two of them, all others lie within ``misses`` per axis.

    From each kept point on, the slopes are narrowed to those that pass every point so far; the last point
    within them is kept next. Each point is looked at once.
    """
    kept: list[int] = [0]
    low, high = [-inf] * len(misses), [inf] * len(misses)
    for index in range(1, len(rows)):
        slopes, span = _slopes(times, rows, kept[-1], index)
        if not all(least <= one <= most for least, one, most in zip(low, slopes, high, strict=True)):
            kept.append(index - 1)
            slopes, span = _slopes(times, rows, index - 1, index)
            low, high = [-inf] * len(misses), [inf] * len(misses)
        low = [max(least, one - miss / span) for least, one, miss in zip(low, slopes, misses, strict=True)]
        high = [min(most, one + miss / span) for most, one, miss in zip(high, slopes, misses, strict=True)]
    return kept if len(rows) < 2 else [*kept, len(rows) - 1]


def _slopes(times: Sequence[float], rows: Sequence[Row], first: int, last: int) -> tuple[list[float], float]:
    """The slope of each axis between two points, and the time between them."""
    span = max(times[last] - times[first], 1e-9)
    return [(one - other) / span for one, other in zip(rows[last], rows[first], strict=True)], span


def _gaps(times: Sequence[float], when: Sequence[float]) -> list[list[int]]:
    """From when to when (ms) something was not there."""
    there, ends = {*when}, [*times[1:], times[-1] + 1e-3]
    runs = groupby(zip(times, ends, strict=True), key=lambda moment: moment[0] in there)
    absent = [list(run) for is_there, run in runs if not is_there]
    return [[round(1000 * run[0][0]), round(1000 * run[-1][1])] for run in absent]


def _turned_like(before: Row, row: Row) -> Row:
    """The same pose, with the one of its two quaternions that is nearer to the one before."""
    if sum(a * b for a, b in zip(before[3:], row[3:], strict=True)) < 0:
        return (*row[:3], *(-value for value in row[3:]))
    return row


def _scales(kind: TrackKind, rows: Sequence[Row]) -> tuple[list[float], list[float]]:
    if kind is TrackKind.VALUE:
        values = [row[0] for row in rows]
        reach = max(max(values) - min(values), 1e-9 * max(map(abs, values)), 1e-12)
        return [float(f"{reach / _STEPS:.3g}")], [_MISS_VALUE]
    turns = kind.width - 3
    return [_LENGTH] * 3 + [_TURN] * turns, [_MISS_LENGTH] * 3 + [_MISS_TURN] * turns


def _differences(numbers: Sequence[int]) -> list[int]:
    return [numbers[0], *(after - before for before, after in pairwise(numbers))]


#: what the page takes for granted where nothing is said
_NOTHING: tuple[Any, ...] = (None, (), [], {}, "")


def mutant_page(result: MutantResult) -> dict[str, Any]:
    """Return all but the recordings: the mutant of the results document, without what is empty."""
    return {**told(data_of(result)), "change": result.change}


def told(value: Any) -> Any:
    """Return data without what is empty."""
    if isinstance(value, dict):
        return {key: told(item) for key, item in value.items() if item not in _NOTHING}
    return [told(item) for item in value] if isinstance(value, list) else value


#: characters of a value that are shown
_LONGEST = 120


@dataclass(slots=True)
class Recorded:
    """The recordings of a campaign, as pages want them.

    Attributes:
        evidence: where they are read from.
        clean: makes texts of the program fit to leave the machine.
        originals: data of the original's recordings that were asked for, by round and test.
    """

    evidence: StoredEvidence
    clean: Callable[[str], str]
    originals: dict[tuple[int, str], Any] = field(default_factory=dict)

    def of(self, result: MutantResult) -> Iterator[dict[str, Any]]:
        """What was recorded of a mutant, the round and test that went farthest from the original first."""
        for round, test in self._places(result):
            original, mutant = mapped(self.evidence.pair(result.mutant.id, round, test), self.clean)
            if mutant is not None:
                yield {
                    "round": round,
                    "test": self.clean(test),
                    "original": self._original(round, test, original),
                    **_data(mutant),
                }

    def count(self, result: MutantResult) -> int:
        """How many recordings there are of a mutant."""
        return sum(len(self.evidence.tests(result.mutant.id, number)) for number in range(len(result.rounds)))

    def _places(self, result: MutantResult) -> Iterator[tuple[int, str]]:
        found = [(number, one) for number, one in enumerate(result.rounds) if one is not None]
        for number, outcome in sorted(found, key=lambda one: (-worst_of(one[1]), one[0])):
            told = [one.test for one in outcome.diverged]
            tests = self.evidence.tests(result.mutant.id, number)
            for test in sorted(tests, key=lambda one: told.index(one) if one in told else len(told)):
                yield number, test

    def _original(self, round: int, test: str, recording: Recording | None) -> int | None:
        """The number of the file with the original's recording; None if there is none."""
        if recording is None:
            return None
        key = (round, test)
        if key not in self.originals:
            self.originals[key] = {"round": round, "test": self.clean(test), **_data(recording)}
        return [*self.originals].index(key)


def _data(recording: Recording) -> dict[str, Any]:
    tracks = (thinned(track, recording.times) for track in recording.tracks.values())
    return {
        "tracks": [one for one in tracks if one],
        "calls": [_call(one) for one in recording.calls],
        "moments": [[one.time, one.what, one.text] for one in recording.moments],
        "blocks": [[one.name, one.centre, one.size, one.colour] for one in recording.blocks],
        "end": recording.times[-1] if recording.times else None,
        "fault": recording.fault,
        "faultyCall": recording.faulty_call,
        "simulated": recording.is_simulated,
        "problems": recording.problems,
    }


def _call(call: Told) -> list[Any]:
    sides = ([[name, _short(value)] for name, value in side.items()] for side in (call.written, call.read))
    return [call.began, call.ended, call.operation, call.place, call.pattern, *sides, call.role]


def _short(value: Any) -> Any:
    if value is None or isinstance(value, bool | int | float):
        return value
    text = value if isinstance(value, str) else value_text(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
