"""A second look: do outcomes come out the same in fresh processes, and can the tests be relied on?

``--verify N`` runs outcomes chosen at random once more by replay, the reference, and compares how they end.
What is in doubt is run again by ``repeats``.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.request import Request
from mutabot.errors import UnstableError
from mutabot.journal.records import Disagreement, Flaky
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.outcome import in_words, same_end

from .engine import Trial
from .fresh import replay


@dataclass(slots=True)
class Looker:
    """What is needed to run a mutant again."""

    campaign: Campaign
    found: dict[tuple[str, int], Outcome] = field(default_factory=dict)

    def look(self, trials: Sequence[Trial], until: float | None = None) -> None:
        """Run these again in fresh processes; none begins after ``until`` (``Request.clock``)."""
        clock = self.campaign.request.clock
        if not trials or (until is not None and clock() >= until):
            return
        self.campaign.progress.stage("second look", len(trials))
        self.run(takewhile(lambda _: until is None or clock() < until, trials))

    def run(self, trials: Iterable[Trial]) -> None:
        """Run these, whatever they did before."""
        for outcome in replay(self.campaign, trials):
            self.found[outcome.mutant, outcome.round] = outcome
            self.campaign.progress.advance(in_words(outcome))


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
        indistinguishable=None, distance=None, divergence=(), gaps=(), way=None, compared=None, figures=(),
    )  # fmt: skip


def disagreement(mutant: Mutant, first: Outcome, second: Outcome) -> Disagreement | None:
    """How two outcomes of a mutant differ; None if they end alike."""
    if same_end(first, second):
        return None
    words = in_words(first), in_words(second)
    if words[0] == words[1]:  # they differ in a later line of the message
        words = f"{first.verdict}: {first.message}", f"{second.verdict}: {second.message}"
    return Disagreement(mutant.id, mutant.number, first.round, *words)
