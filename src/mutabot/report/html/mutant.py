"""The data of one mutant's page: how it ended, and what was recorded of it; of originals the latter.

Tracks have fewer points: what a straight line in time keeps within half a millimetre is left out.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import isnan
from typing import Any

from mutabot.evidence.recording import Kind, Recording, Told, Track
from mutabot.model import Looked, Outcome
from mutabot.model.quantity import value_text
from mutabot.report.document import data_of
from mutabot.report.texts import mapped, rounds_text
from mutabot.results.divergence import worst_of
from mutabot.results.results import MutantResult
from mutabot.results.stored import StoredEvidence

#: what one step of the whole numbers is, and by how many steps a line may miss: m; quaternions without unit
_LENGTH, _TURN = 1e-4, 1e-3
_MISS_LENGTH, _MISS_TURN = 5.0, 3.0
#: steps over the range of a value, and by how many a line may miss
_STEPS, _MISS_VALUE = 2000, 8.0

Row = tuple[float, ...]


def thinned(track: Track, times: Sequence[float], usual: Track | None, usual_times: Sequence[float]) -> Any:
    """A track as data: times in ms and numbers in steps, each as the difference from the one before.

    ``usual``: the same thing in the original. What both begin with is left to it: the data say ``from`` which
    moment (ms) on they hold.
    """
    rows, when, gaps = _rows(track, times)
    if not rows:
        return None
    scales, misses = _scales(track.kind, rows)
    start = _same_until(track, times, usual, usual_times)
    first = max(0, bisect_left(when, start) - 1) if start > 0 else 0
    rows, when = rows[first:], when[first:]
    steps = [tuple(value / scale for value, scale in zip(row, scales, strict=True)) for row in rows]
    kept = kept_points(when, steps, misses)
    channels = [[round(steps[index][axis]) for index in kept] for axis in range(len(scales))]
    return {
        "name": track.name,
        "kind": track.kind.value,
        "unit": track.unit,
        **({"size": list(track.size)} if track.size is not None else {}),
        **({"from": round(1000 * when[0])} if first else {}),
        **({"gaps": gaps} if gaps else {}),
        "scales": scales,
        "t": _differences([round(1000 * when[index]) for index in kept]),
        "v": [_differences(channel) for channel in channels],
    }


def kept_points(times: Sequence[float], rows: Sequence[Row], misses: Sequence[float]) -> list[int]:
    """The points to keep: on a line between two of them, all others lie within ``misses`` per axis.

    From each kept point on, the slopes are narrowed to those that pass every point so far; the last point
    within them is kept next. Each point is looked at once.
    """
    if len(rows) < 3:
        return list(range(len(rows)))
    kept, cone, index = [0], _Cone(), 1
    while index < len(rows):
        anchor = kept[-1]
        span = max(times[index] - times[anchor], 1e-9)
        slopes = [(one - other) / span for one, other in zip(rows[index], rows[anchor], strict=True)]
        if cone.holds(slopes):
            cone.narrow(slopes, [miss / span for miss in misses])
            index += 1
        else:
            kept.append(max(index - 1, anchor + 1))
            cone, index = _Cone(), kept[-1] + 1
    if kept[-1] != len(rows) - 1:
        kept.append(len(rows) - 1)
    return kept


class _Cone:
    """The slopes of lines that pass near enough to every point since the last that was kept."""

    def __init__(self) -> None:
        self._low: list[float] | None = None
        self._high: list[float] = []

    def holds(self, slopes: Sequence[float]) -> bool:
        """Whether a line with these slopes does."""
        if self._low is None:
            return True
        return all(low <= one <= high for low, one, high in zip(self._low, slopes, self._high, strict=True))

    def narrow(self, slopes: Sequence[float], misses: Sequence[float]) -> None:
        """One more point: lines may miss it by so much."""
        low = [one - miss for one, miss in zip(slopes, misses, strict=True)]
        high = [one + miss for one, miss in zip(slopes, misses, strict=True)]
        if self._low is not None:
            low, high = [*map(max, low, self._low)], [*map(min, high, self._high)]
        self._low, self._high = low, high


def _rows(track: Track, times: Sequence[float]) -> tuple[list[Row], list[float], list[list[int]]]:
    """The moments at which it was there, and from when to when (ms) it was not."""
    width, values = track.kind.width, track.values
    rows: list[Row] = []
    when: list[float] = []
    gaps: list[list[int]] = []
    gone: float | None = None
    for number, time in enumerate(times):
        row = tuple(values[number * width : (number + 1) * width])
        if isnan(row[0]):
            gone = time if gone is None else gone
            continue
        if gone is not None:
            gaps.append([round(1000 * gone), round(1000 * time)])
            gone = None
        rows.append(_turned_like(rows[-1], row) if rows and track.kind is Kind.POSE else row)
        when.append(time)
    if gone is not None:
        gaps.append([round(1000 * gone), round(1000 * times[-1]) + 1])
    return rows, when, gaps


def _turned_like(before: Row, row: Row) -> Row:
    """The same pose, with the one of its two quaternions that is nearer to the one before."""
    if sum(a * b for a, b in zip(before[3:], row[3:], strict=True)) < 0:
        return (*row[:3], *(-value for value in row[3:]))
    return row


def _scales(kind: Kind, rows: Sequence[Row]) -> tuple[list[float], list[float]]:
    if kind is Kind.VALUE:
        values = [row[0] for row in rows]
        reach = max(max(values) - min(values), 1e-9 * max(map(abs, values)), 1e-12)
        return [float(f"{reach / _STEPS:.3g}")], [_MISS_VALUE]
    turns = kind.width - 3
    return [_LENGTH] * 3 + [_TURN] * turns, [_MISS_LENGTH] * 3 + [_MISS_TURN] * turns


def _same_until(
    track: Track, times: Sequence[float], usual: Track | None, usual_times: Sequence[float]
) -> float:
    """Until when, s, a track is the original's to the last bit."""
    if usual is None or usual.kind is not track.kind:
        return 0.0
    width = track.kind.width
    until = 0.0
    for count, (one, other) in enumerate(zip(times, usual_times, strict=False)):
        here = slice(count * width, (count + 1) * width)
        if one != other or track.values[here].tobytes() != usual.values[here].tobytes():
            break
        until = one
    return until


def _differences(numbers: Sequence[int]) -> list[int]:
    return [numbers[0], *(after - before for before, after in pairwise(numbers))]


#: what the page takes for granted where nothing is said
_NOTHING: tuple[Any, ...] = (None, (), [], "")
#: checks of a test that are shown; the journal has more
_CHECKS = 40


def mutant_page(result: MutantResult) -> dict[str, Any]:
    """All but what was recorded."""
    return {
        **data_of.facts(
            result,
            "number=mutant.number id=mutant.id pattern=mutant.pattern_name change "
            "interval=kill_rate.interval",
        ),
        "places": [data_of.facts(result.mutant.site, "place function=span.function")],
        "meaning": _meaning_words(result),
        "roundsText": rounds_text(result),
        "rounds": [_round(one) for one in result.rounds],
        "looked": _looked(result),
    }


def _meaning_words(result: MutantResult) -> list[str]:
    quantity = result.quantity
    if quantity is None:
        return []
    words = (
        quantity.kind.value,
        quantity.axis and f"axis {quantity.axis}",
        quantity.unit and f"in {quantity.unit}",
        quantity.mode and f"{quantity.mode.value} an amount" if quantity.mode == "by" else None,
        quantity.frame and f"frame {quantity.frame}",
    )
    return [word for word in words if word]


def _round(outcome: Outcome | None) -> dict[str, Any] | None:
    if outcome is None:
        return None
    known = {
        **data_of.facts(
            outcome,
            "test exception message place hits acted tests wall simulated divergence gaps "
            "compared=compared.text indistinguishable engine repeats stuck beside",
        ),
        "away": [[why, count] for why, count in outcome.away.items()],
        "example": [_value(one) for one in outcome.example] if outcome.example is not None else None,
        "unconfirmed": outcome.confirmed is False or None,
        "kills": [[one.test, one.by.value, one.message] for one in outcome.kills[1:]],
        "diverged": [_told(data_of.facts(one, "*")) for one in outcome.diverged],
    }
    return _told(known)


def _told(data: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in data.items() if value not in _NOTHING}


def _looked(result: MutantResult) -> dict[str, Any] | None:
    """The first round that it survived: who ran it, what they checked, and by how much that held."""
    for number, outcome in enumerate(result.rounds):
        if outcome is not None and outcome.looked:
            first_of_use = sorted(outcome.looked, key=lambda one: not one.acted)
            return {"round": number, "tests": [_test(one) for one in first_of_use]}
    return None


def _test(looked: Looked) -> dict[str, Any]:
    more = looked.more + max(0, len(looked.checks) - _CHECKS)
    return {
        "test": looked.test,
        "acted": looked.acted,
        "more": more,
        "checks": [[one.place, one.text, one.seen, one.spare, one.times] for one in looked.checks[:_CHECKS]],
    }


def _value(value: Any) -> Any:
    return value if value is None or isinstance(value, bool | int | float | str) else repr(value)


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
                    **_data(mutant, original),
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
            self.originals[key] = {"round": round, "test": self.clean(test), **_data(recording, None)}
        return [*self.originals].index(key)


def _data(recording: Recording, usual: Recording | None) -> dict[str, Any]:
    others: Mapping[str, Any] = usual.tracks if usual is not None else {}
    times = usual.times if usual is not None else ()
    tracks = (
        thinned(track, recording.times, others.get(name), times) for name, track in recording.tracks.items()
    )
    calls = _shared(recording.calls, usual.calls) if usual is not None else 0
    return {
        "tracks": [one for one in tracks if one],
        "callsFrom": calls,
        "calls": [_call(one) for one in recording.calls[calls:]],
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


def _shared(calls: Sequence[Told], usual: Sequence[Told]) -> int:
    """How many calls both begin with."""
    pairs = enumerate(zip(calls, usual, strict=False))
    return next((count for count, (one, other) in pairs if one != other), min(len(calls), len(usual)))
