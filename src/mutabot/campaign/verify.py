"""A second look: do outcomes come out the same in fresh processes, and can the tests be relied on?

``--verify N`` runs outcomes chosen at random once more by replay, the reference, and compares how they end.
``--confirm`` does so with all kills, survivors and time-outs, see ``repeats``.
"""

from __future__ import annotations

import random
import re
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile
from typing import Any

from mutabot.errors import ControlError, SelectionError, UnstableError
from mutabot.model import Mutant, Outcome, Verdict

from .baseline import Baseline, take_baseline
from .controls import run_controls
from .journal import Journal
from .pairs import pair
from .places import Place
from .plan import make_plan
from .replay import Pair, replay
from .request import Progress, Request
from .workers import Workers

#: keys of the journal's meta
VERIFICATION, CONFIRMATION, FLAKY = "verification", "confirmation", "flaky"
#: parts of a message that differ between equal runs in different processes: addresses, temporary folders,
#: and the last words of a process that died, which only a process of its own can have
_ACCIDENTAL = (
    (re.compile(r"0x[0-9a-fA-F]{6,}"), "0x…"),
    (re.compile(r"pytest-\d+"), "pytest-…"),
    (re.compile(r"; it said last: .*", re.DOTALL), ""),
)


@dataclass(frozen=True, slots=True)
class Disagreement:
    """An outcome that came out otherwise in a fresh process.

    Attributes:
        mutant, number: id and number of the mutant.
        round: 0-based round.
        first, second: how it ended in the campaign and in the fresh process, in words.
    """

    mutant: str
    number: int
    round: int
    first: str
    second: str


@dataclass(frozen=True, slots=True)
class Verification:
    """What ``--verify`` found.

    Attributes:
        wanted: how many outcomes were to be looked at.
        checked: how many were; fewer if the campaign has no more that any test was run for.
        disagreements: those that came out otherwise.
    """

    wanted: int
    checked: int
    disagreements: tuple[Disagreement, ...] = ()

    @property
    def agreed(self) -> int:
        """How many came out the same."""
        return self.checked - len(self.disagreements)


@dataclass(frozen=True, slots=True)
class Flaky:
    """Tests that cannot be relied on: they differ between equal runs of the original, or fail in one round.

    Attributes:
        tests: one line each: test, round and reason.
        known: number of (test, round) that could have been.
    """

    tests: tuple[str, ...] = ()
    known: int = 0

    @classmethod
    def of(cls, baseline: Baseline) -> Flaky:
        """What is known now: with the branch engine, the trunks give the second opinion."""
        lines = [f"{test} in round {round + 1}: {why}" for (round, test), why in baseline.unstable.items()]
        known = sum(len(baseline.ran(round)) for round in range(len(baseline.tests)))
        return cls(tuple(lines), known + len(lines))

    @property
    def share(self) -> float:
        """The share of tests that are flaky."""
        return len(self.tests) / self.known if self.known else 0.0

    def text(self, limit: float) -> str:
        """Why this is too much."""
        shown = "".join(f"\n  {line}" for line in self.tests[:10])
        more = f"\n  … and {len(self.tests) - 10} more" if len(self.tests) > 10 else ""
        counts = f"{len(self.tests)} of {self.known} tests cannot be relied on ({self.share:.0%})"
        return f"{counts}; the limit is {limit:.0%} (unstable_limit):{shown}{more}"


@dataclass(frozen=True, slots=True)
class Replayed:
    """One mutant in one round, run again.

    Attributes:
        round: 0-based round.
        first: its outcome in the journal; None if it has none.
        second: its outcome now.
    """

    round: int
    first: Outcome | None
    second: Outcome

    @property
    def agrees(self) -> bool | None:
        """Whether both ended alike; None if there is nothing to compare with."""
        return None if self.first is None else same_end(self.first, self.second)


@dataclass(slots=True)
class Looker:
    """What is needed to run a mutant again."""

    request: Request
    baseline: Baseline
    workers: Workers
    progress: Progress
    found: dict[tuple[str, int], Outcome] = field(default_factory=dict)

    def look(
        self,
        pairs: Sequence[Pair],
        first: Mapping[tuple[str, int], Outcome],
        until: float | None = None,
    ) -> None:
        """Run these again in fresh processes; none begins after ``until`` (``time.monotonic``)."""
        if not pairs or (until is not None and time.monotonic() >= until):
            return
        self.progress.stage("second look", len(pairs))
        self.run(takewhile(lambda _: until is None or time.monotonic() < until, pairs))
        found = [pair for pair in pairs if _key(pair) in self.found]
        doubtful = [pair for pair in found if not same_end(first[_key(pair)], self.found[_key(pair)])]
        if doubtful and self._learn_dependent(mutant for mutant, _ in doubtful):
            self.progress.stage("second look, with the whole suite", len(doubtful))
            self.run(doubtful)

    def run(self, pairs: Iterable[Pair]) -> None:
        """Run these, whatever they did before."""
        for outcome in replay(self.request, self.baseline, self.workers, pairs):
            self.found[outcome.mutant, outcome.round] = outcome
            self.progress.advance(in_words(outcome))

    def _learn_dependent(self, mutants: Iterable[Mutant]) -> bool:
        """Whether there are tests that pass only after others, which a trunk never notices."""
        before = len(self.baseline.dependent)
        try:
            for _ in run_controls(self.request, self.baseline, self.workers, self.progress, mutants):
                pass
        except ControlError as error:
            self.progress.note(str(error))
        return len(self.baseline.dependent) > before


def refuse_flaky(request: Request, baseline: Baseline) -> None:
    """Raise UnstableError if more tests are flaky than the configuration allows."""
    flaky = Flaky.of(baseline)
    limit = request.configuration.unstable_limit
    if flaky.share > limit:
        raise UnstableError(flaky.text(limit), tests=[test for _, test in baseline.unstable])


def replay_one(
    request: Request, journal: Journal, mutant: Mutant, rounds: Iterable[int], progress: Progress
) -> list[Replayed]:
    """Run one mutant again in these rounds, beside what the journal says of it.

    Raises SelectionError if the program no longer has the mutant, and what a baseline raises.
    """
    rounds = sorted(set(rounds))
    request = replace(request, rounds=rounds[-1] + 1, engine="replay")
    first = {(one.mutant, one.round): one for one in journal.outcomes()}
    with Workers(request.root, request.arguments, request.jobs) as workers:
        baseline, _ = take_baseline(request, workers, progress, repetitions=1)
        mutant = _as_it_is_now(request, baseline, mutant)
        looker = Looker(request, baseline, workers, progress)
        for _ in run_controls(request, baseline, workers, progress, [mutant]):
            pass
        pairs = [(mutant, round) for round in rounds]
        progress.stage("replay", len(pairs))
        looker.run(pairs)
    return [
        Replayed(round, first.get((mutant.id, round)), looker.found[mutant.id, round]) for round in rounds
    ]


def choose(outcomes: Iterable[Outcome], count: int, seed: int) -> list[tuple[str, int]]:
    """So many mutants and rounds at random, always the same for equal seeds and outcomes.

    Outcomes for which no test was run are left out: there is nothing to run again.
    """
    ran = sorted((one.mutant, one.round) for one in outcomes if one.tests or one.test is not None)
    return random.Random(f"{seed}:verify").sample(ran, min(count, len(ran)))


def same_end(first: Outcome, second: Outcome) -> bool:
    """Whether two outcomes are the same in verdict, in what noticed it, in the test and in the message."""
    return _end(first) == _end(second)


def in_words(outcome: Outcome) -> str:
    """How a mutant ended: ``killed by check in tests/test_box.py::test_arrives: assert 1 == 2``."""
    lines = (outcome.message or "").strip().splitlines()
    return f"{end_in_words(outcome)}{f': {lines[0]}' if lines else ''}"


def end_in_words(outcome: Outcome) -> str:
    """The same without the message."""
    by = f" by {outcome.by}" if outcome.by is not None else ""
    test = f" in {outcome.test}" if outcome.test is not None else ""
    return f"{outcome.verdict}{by}{test}"


def unconfirmed(first: Outcome, second: Outcome) -> Outcome:
    """The outcome of a mutant that ended otherwise at a second look."""
    text = f"{in_words(first)}; run once more: {in_words(second)}"
    return replace(
        first, verdict=Verdict.UNSTABLE, by=None, test=second.test or first.test, message=text,
        indistinguishable=None, distance=None, divergence=(), gaps=(), way=None, compared=None,
    )  # fmt: skip


def _key(pair: Pair) -> tuple[str, int]:
    return pair[0].id, pair[1]


def without_accidents(message: str | None) -> str | None:
    """A message without what differs between equal runs in different processes."""
    for pattern, text in _ACCIDENTAL if message is not None else ():
        message = pattern.sub(text, message or "")
    return message


def _end(outcome: Outcome) -> tuple[Any, ...]:
    return outcome.verdict, outcome.by, outcome.test, without_accidents(outcome.message)


def disagreement(mutant: Mutant, first: Outcome, second: Outcome) -> Disagreement | None:
    """How two outcomes of a mutant differ; None if they end alike."""
    if same_end(first, second):
        return None
    words = in_words(first), in_words(second)
    if words[0] == words[1]:  # they differ in a later line of the message
        words = f"{first.verdict}: {first.message}", f"{second.verdict}: {second.message}"
    return Disagreement(mutant.id, mutant.number, first.round, *words)


def _as_it_is_now(request: Request, baseline: Baseline, mutant: Mutant) -> Mutant:
    """The mutant in the program as it is now: edits elsewhere move it."""
    if Place.of(mutant) in baseline.hits:
        return mutant
    planned = {one.id: one for one in make_plan(baseline, request.vocabulary, request.families).mutants}
    gone = next((one.id for one in mutant.singles if one.id not in planned), None)
    if gone is not None:
        problem = f"the program has changed: no test reaches {gone} any more"
        raise SelectionError(problem, unknown=[mutant.id])
    now = [planned[one.id] for one in mutant.singles]
    return pair(mutant.number, *now) if mutant.parts else replace(now[0], number=mutant.number)
