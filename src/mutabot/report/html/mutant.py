"""The data of one mutant's page: how it ended, and what was recorded of it; of originals once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from mutabot.analysis.divergence import change_text, worst_of
from mutabot.analysis.results import MutantResult
from mutabot.analysis.stored.evidence import StoredEvidence
from mutabot.border.codec import to_data
from mutabot.evidence.recording import Block, Moment, Recording, Told
from mutabot.model import Looked, Outcome
from mutabot.model.values.quantity import value_text
from mutabot.report.as_json import facts
from mutabot.report.html.thin import thinned
from mutabot.report.status import rounds_text

#: what the page takes for granted where nothing is said
_NOTHING: tuple[Any, ...] = (None, (), [], "")
#: checks of a test that are shown; the journal has more
_CHECKS = 40


def mutant_page(result: MutantResult) -> dict[str, Any]:
    """All but what was recorded."""
    mutant = result.mutant
    interval = result.kill_rate.interval
    quantity = result.quantity
    change = next(filter(None, (change_text(mutant, one, quantity) for one in result.outcomes)), None)
    return {
        "number": mutant.number,
        "id": mutant.id,
        "places": [{"place": mutant.site.place, "function": mutant.site.span.function}],
        "pattern": mutant.pattern_name,
        "meaning": _meaning_words(result),
        "interval": [interval.low, interval.high] if interval is not None else None,
        "roundsText": rounds_text(result),
        "change": change,
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
        **facts(outcome, "test exception message place hits acted"),
        "away": [[why, count] for why, count in outcome.away.items()],
        "example": [_value(one) for one in outcome.example] if outcome.example is not None else None,
        **facts(outcome, "tests wall simulated divergence gaps"),
        "compared": outcome.compared.text if outcome.compared is not None else None,
        **facts(outcome, "indistinguishable engine repeats stuck beside"),
        "kills": [[one.test, one.by.value, one.message] for one in outcome.kills[1:]],
        "diverged": [_told(to_data(one)) for one in outcome.diverged],
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
    _numbers: dict[tuple[int, str], int] = field(default_factory=dict)

    def of(self, result: MutantResult) -> Iterator[dict[str, Any]]:
        """What was recorded of a mutant, the round and test that went farthest from the original first."""
        for round, test in self._places(result):
            pair = self.evidence.pair(result.mutant.id, round, test)
            if pair.mutant is None:
                continue
            yield {
                "round": round,
                "test": self.clean(test),
                "original": self._original(round, test, pair.original),
                **self._data(pair.mutant, pair.original),
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
        if key not in self._numbers:
            self._numbers[key] = len(self._numbers)
            self.originals[key] = {"round": round, "test": self.clean(test), **self._data(recording, None)}
        return self._numbers[key]

    def _data(self, recording: Recording, usual: Recording | None) -> dict[str, Any]:
        others: Mapping[str, Any] = usual.tracks if usual is not None else {}
        times = usual.times if usual is not None else ()
        tracks = (
            thinned(track, recording.times, others.get(name), times)
            for name, track in recording.tracks.items()
        )
        calls = _shared(recording.calls, usual.calls) if usual is not None else 0
        return {
            "tracks": [
                {**one, "name": self.clean(one["name"]), "unit": self.clean(one["unit"])}
                for one in tracks
                if one
            ],
            "callsFrom": calls,
            "calls": [self._call(one) for one in recording.calls[calls:]],
            "moments": [self._moment(one) for one in recording.moments],
            "blocks": [self._block(one) for one in recording.blocks],
            "end": recording.times[-1] if recording.times else None,
            "fault": recording.fault,
            "faultyCall": recording.faulty_call,
            "simulated": recording.is_simulated,
            "problems": [self.clean(one) for one in recording.problems],
        }

    def _call(self, call: Told) -> list[Any]:
        return [
            call.began,
            call.ended,
            self.clean(call.operation),
            self.clean(call.place),
            self.clean(call.pattern) if call.pattern is not None else None,
            self._values(call.written),
            self._values(call.read),
            call.role,
        ]

    def _values(self, values: Mapping[str, Any]) -> list[list[Any]]:
        return [[self.clean(name), self._value(value)] for name, value in values.items()]

    def _value(self, value: Any) -> Any:
        if value is None or isinstance(value, bool | int | float):
            return value
        text = self.clean(value if isinstance(value, str) else value_text(value))
        return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"

    def _moment(self, moment: Moment) -> list[Any]:
        return [moment.time, moment.what, self.clean(moment.text)]

    def _block(self, block: Block) -> list[Any]:
        return [self.clean(block.name), block.centre, block.size, block.colour]


def _shared(calls: Sequence[Told], usual: Sequence[Told]) -> int:
    """How many calls both begin with."""
    count = 0
    for one, other in zip(calls, usual, strict=False):
        if one != other:
            break
        count += 1
    return count
