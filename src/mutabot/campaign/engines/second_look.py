"""A second look: do outcomes come out the same in fresh processes, and can the tests be relied on?

``--verify N`` runs outcomes chosen at random once more by replay, the reference, and compares how they end.
``--confirm`` does so with all kills, survivors and time-outs, see ``repeats``.
"""

from __future__ import annotations

import random
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile

from mutabot.campaign.baseline.baseline import Baseline, take_baseline
from mutabot.campaign.baseline.places import Place
from mutabot.campaign.plan.plan import make_plan
from mutabot.campaign.plan.second_order import pair
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.workers.workers import Workers
from mutabot.errors import ControlError, SelectionError, UnstableError
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import Disagreement, Flaky, Replayed
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.outcome import in_words, same_end

from .controls import run_controls
from .replay import Pair, replay


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


def flaky_of(baseline: Baseline) -> Flaky:
    """What is known now: with the branch engine, the trunks give the second opinion."""
    lines = [f"{test} in round {round + 1}: {why}" for (round, test), why in baseline.unstable.items()]
    known = sum(len(baseline.ran(round)) for round in range(len(baseline.tests)))
    return Flaky(tuple(lines), known + len(lines))


def refuse_flaky(request: Request, baseline: Baseline) -> None:
    """Raise UnstableError if more tests are flaky than the configuration allows."""
    flaky = flaky_of(baseline)
    limit = request.configuration.unstable_limit
    if flaky.share > limit:
        raise UnstableError(flaky.text(limit), tests=[test for _, test in baseline.unstable])


def replay_one(
    request: Request, journal: JournalReader, mutant: Mutant, rounds: Iterable[int], progress: Progress
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


def unconfirmed(first: Outcome, second: Outcome) -> Outcome:
    """The outcome of a mutant that ended otherwise at a second look."""
    text = f"{in_words(first)}; run once more: {in_words(second)}"
    return replace(
        first, verdict=Verdict.UNSTABLE, by=None, test=second.test or first.test, message=text,
        indistinguishable=None, distance=None, divergence=(), gaps=(), way=None, compared=None,
    )  # fmt: skip


def _key(pair: Pair) -> tuple[str, int]:
    return pair[0].id, pair[1]


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
