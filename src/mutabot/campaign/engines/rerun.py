"""Re-run outcomes in fresh processes, and record which of them change.

``--verify N`` runs outcomes chosen at random and compares how they end. Of a campaign over a simulation they
run over the real middleware, a few of them in any case: what comes out otherwise there, twice, is believed
instead, and the next ones are run until as many agree. Kills that may be chance are run
again too. A test in simulated time whose runs of the original are equal to the last bit is taken to be
deterministic. Of any other test a kill is in doubt if the test is known to be unreliable, or if it kills so
few of the mutants that it judges that it might do so by failing at random. An end is in doubt where its
operator leaves to chance what happens.

A kill that does not come out again becomes ``unstable``, and all other kills of its test are in doubt as
well. Kills in doubt are repeated cheapest first, within a small share of the campaign's time, and a larger
one as soon as one does not come out again. How many were left is reported.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate, takewhile

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.suite_runs import FAILS
from mutabot.campaign.campaign import Campaign, RunId
from mutabot.campaign.faults.providers import provider
from mutabot.campaign.request import VERIFIED, Request
from mutabot.campaign.reuse.keys import OutcomeWriter
from mutabot.errors import UnstableError
from mutabot.journal import records
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.outcome_text import outcome_text, same_end

from .replay import replay

#: this number of kills of a test, or this share of what it judges, could be failures at random
_FEW, _SHARE = 2, 0.1
#: repeats of kills in doubt may take this share of the time that the campaign has taken
SHARE = 0.05
#: the same once a kill has not come out again, and for what is left to chance; or this number of seconds
MOST_SHARE, MOST_SECONDS = 0.1, 10.0
#: how often an outcome is repeated whose operator leaves to chance what happens
RACES = 3


@dataclass(slots=True)
class Doubts:
    """The outcomes of a campaign that are in doubt.

    Attributes:
        baseline: what is known about the tests.
        mutants: by id.
        outcomes: by mutant and round, before any was repeated.
        unreliable: tests that have been seen to end otherwise in equal runs, in any round.
    """

    baseline: Baseline
    mutants: Mapping[str, Mutant]
    outcomes: Mapping[RunId, Outcome]
    unreliable: set[str] = field(init=False)

    def __post_init__(self) -> None:
        flaky = (test for (_, test), why in self.baseline.unstable.items() if not why.startswith(FAILS))
        self.unreliable = {*self.baseline.doubted, *(test for _, test in self.baseline.inexact), *flaky}

    def kills(self) -> list[RunId]:
        """Return all kills by a test that ended."""
        return [
            key
            for key, outcome in self.outcomes.items()
            if outcome.verdict is Verdict.KILLED and outcome.test
        ]

    def in_doubt(self) -> list[RunId]:
        """Return the kills that may be chance and were not repeated by an earlier campaign."""
        few = self.isolated_kills()
        kills = (key for key in self.kills() if not self.outcomes[key].repeats)
        return [key for key in kills if self._test(key) in self.unreliable or key in few]

    def raced(self) -> list[RunId]:
        """Return outcomes of racy operators that no earlier campaign has repeated."""
        return [
            key
            for key, outcome in self.outcomes.items()
            if outcome.verdict in (Verdict.KILLED, Verdict.SURVIVED) and not outcome.repeats
            if provider(self.mutants[key[0]].provider).is_raced(self.mutants[key[0]].operator)
        ]

    def is_certain(self, key: RunId) -> bool:
        """Return whether a kill was repeated before, or its test is taken to be deterministic."""
        test = self._test(key)
        is_deterministic = test not in self.unreliable and self._has_clock(test, key[1])
        return bool(self.outcomes[key].repeats) or is_deterministic

    def isolated_kills(self) -> set[RunId]:
        """Kills seen in only one round, by tests without a simulated clock that rarely produce them."""
        times = Counter((key[0], self._test(key)) for key in self.kills())
        lone: dict[str, list[RunId]] = {}
        for key in self.kills():
            test = self._test(key)
            if times[key[0], test] == 1 and not self._has_clock(test, key[1]):
                lone.setdefault(test, []).append(key)
        judged = Counter(
            test
            for key, outcome in (self.outcomes.items() if lone else ())
            for test in lone.keys() & set(self._ran(key))
            if test == outcome.test or test in self.baseline.tests_reaching(key[1], self.mutants[key[0]])
        )
        few = (keys for test, keys in lone.items() if len(keys) < judged[test])
        most = {test: max(_FEW, _SHARE * count) for test, count in judged.items()}
        return {key for keys in few if len(keys) <= most[self._test(keys[0])] for key in keys}

    def _ran(self, key: RunId) -> tuple[str, ...]:
        """Return the tests of the suite that a mutant ran."""
        outcome, suite = self.outcomes[key], self.baseline.suite(key[1])
        if outcome.test in suite and not outcome.complete:
            return suite[: suite.index(outcome.test) + 1]
        return suite if outcome.tests else ()

    def cost(self, key: RunId) -> float:
        """Return the time (s) that a repeat takes on the original."""
        return self.baseline.startup + self.baseline.seconds(key[1], self._ran(key))

    def _test(self, key: RunId) -> str:
        return self.outcomes[key].test or ""

    def _has_clock(self, test: str, round: int) -> bool:
        end = self.baseline.ends.get((round, test))
        return end is not None and end.simulated is not None


def rerun(campaign: Campaign, mutants: Sequence[Mutant], writer: OutcomeWriter, spent: float) -> None:
    """Verify and repeat outcomes, and record the results, flaky tests included.

    ``spent``: seconds that the campaign has taken until now.
    """
    request, journal = campaign.request, writer.journal
    journal.set_meta(records.FLAKY, flaky_of(campaign.baseline))
    by_id = {mutant.id: mutant for mutant in mutants}
    outcomes = {
        (outcome.mutant, outcome.round): outcome for outcome in journal.outcomes() if outcome.mutant in by_id
    }
    reruns = _Reruns(campaign, writer, Doubts(campaign.baseline, by_id, outcomes))
    default = VERIFIED if campaign.real is not None else 0
    if count := default if request.verify is None else request.verify:
        reruns.verify(count)
    if request.repeats:
        reruns.repeat(SHARE * spent, max(MOST_SHARE * spent, MOST_SECONDS))
    journal.set_meta(records.REPEATS, reruns.summary())


@dataclass(slots=True)
class _Reruns:
    """The reruns of one campaign.

    Attributes:
        found: the last rerun of each outcome.
        times: how often those were repeated that have come out again.
        settled: those that the real middleware has decided.
    """

    campaign: Campaign
    writer: OutcomeWriter
    doubts: Doubts
    found: dict[RunId, Outcome] = field(default_factory=dict)
    times: Counter[RunId] = field(default_factory=Counter)
    settled: set[RunId] = field(default_factory=set)

    def verify(self, count: int) -> None:
        """Re-run this many outcomes, and note which ended differently.

        What was found first stays, unless it was over a simulation.
        """
        real, seed = self.campaign.real, self.campaign.request.seed
        left, checked, wrong = dict(self.doubts.outcomes), 0, list[records.Disagreement]()
        if real is not None:
            left = {
                key: outcome for key, outcome in left.items()
                if real.baseline.tests_reaching(key[1], self.doubts.mutants[key[0]])
            }  # fmt: skip
        while keys := choose(left.values(), count, seed):
            self._run(keys, over=real)
            differing = [key for key in keys if self._differs(key)]
            if real is not None:
                differing = self._believe(real, differing)
            checked += len(keys)
            wrong += [
                _disagreement(self.doubts.mutants[key[0]], self.doubts.outcomes[key], self.found[key])
                for key in differing
            ]
            left = {key: outcome for key, outcome in left.items() if key not in self.found}
            if real is None or not differing:
                break
        result = records.Verification(count, checked, tuple(wrong))
        self.writer.journal.set_meta(records.VERIFICATION, result)
        where = "" if real is None else " over the real middleware"
        self.campaign.progress.note(f"verify: {result.agreed} of {result.checked} outcomes agree{where}")

    def _differs(self, key: RunId) -> bool:
        """Return whether an outcome changed; over a simulation, tests and messages may differ."""
        first, second = self.doubts.outcomes[key], self.found[key]
        return self._is_changed(key) if self.campaign.real is not None else not same_end(first, second)

    def _believe(self, real: Campaign, keys: Sequence[RunId]) -> list[RunId]:
        """Re-run over the real middleware; an outcome that comes out so twice counts, any other is unstable.

        Returns the first ones.
        """
        first = {key: self.found[key] for key in keys}
        self._run(keys, over=real)
        self.settled.update(keys)
        equal = [key for key in keys if self.found[key].verdict is first[key].verdict]
        for key in keys:
            second = self.found[key]
            self.writer.add_outcome(second if key in equal else unconfirmed(first[key], second))
        return equal

    def repeat(self, seconds: float, most: float) -> None:
        """Re-run doubtful outcomes, and any they cast doubt on; those of racy operators several times.

        Takes ``seconds`` seconds, or up to ``most`` seconds if an outcome is not reproduced.
        """
        began = self.campaign.request.clock()
        raced, repeated, changed = set(self.doubts.raced()), set[RunId](), set[RunId]()
        while due := self._due(raced, changed):
            seconds = max(seconds, most) if changed or raced else seconds
            looked = self._run(due, began + seconds)
            if not looked:
                break
            repeated.update(looked)
            wrong = {key for key in looked if self._settle(key)}
            changed |= wrong
            self.doubts.unreliable.update(self.doubts.outcomes[key].test or "" for key in wrong - raced)
        if repeated or due:
            left = f"; {len(due)} not re-run, as re-runs may take {seconds:.0f} s" if due else ""
            kinds = "doubtful kills and races" if raced else "doubtful kills"
            again = f"{len(repeated) - len(changed)} of {len(repeated)}"
            self.campaign.progress.note(f"re-runs: {again} {kinds} confirmed{left}")

    def _due(self, raced: Collection[RunId], changed: Collection[RunId]) -> list[RunId]:
        """Return the outcomes to repeat next."""
        found = dict.fromkeys([*self.doubts.in_doubt(), *raced])
        times = {key: RACES if key in raced else 1 for key in found}
        done = self.settled.union(changed)
        return [key for key in found if key not in done and self.times[key] < times[key]]

    def summary(self) -> records.Repeats:
        """Return how many outcomes of each kind were repeated, and how many of these changed."""
        kills = self.doubts.kills()
        certain = {key for key in kills if key not in self.found and self.doubts.is_certain(key)}
        doubted = set(self.doubts.in_doubt()) - certain
        others = [key for key in kills if key not in certain and key not in doubted]
        survivors = [
            key for key, outcome in self.doubts.outcomes.items() if outcome.verdict is Verdict.SURVIVED
        ]
        return records.Repeats(
            self._counted(doubted), self._counted(others), len(certain), self._counted(survivors)
        )

    def _counted(self, keys: Iterable[RunId]) -> records.Repeated:
        keys = list(keys)
        looked = [key for key in keys if key in self.found]
        return records.Repeated(len(keys), len(looked), sum(map(self._is_changed, looked)))

    def _run(
        self, keys: Sequence[RunId], until: float | None = None, over: Campaign | None = None
    ) -> list[RunId]:
        """Re-run these in fresh processes, cheapest first. Return those that were run.

        None begins after ``until`` (``Request.clock``), and but for the first of all none that would end
        after it with those before it. ``over``: another campaign than this one.
        """
        request, looked = self.campaign.request, list[RunId]()
        cheapest = sorted(keys, key=self.doubts.cost)
        at_once, free = request.clock(), not self.found
        costs = accumulate(self.doubts.cost(key) / request.jobs for key in cheapest)
        ends = [at_once if free and not number else at_once + cost for number, cost in enumerate(costs)]

        def is_in_time(end: float) -> bool:  # they are asked for a little ahead
            return until is None or (end < until and request.clock() < until)

        if not any(map(is_in_time, ends[:1])):
            return looked
        self.campaign.progress.stage("second look", len(keys))
        due = takewhile(lambda run_and_end: is_in_time(run_and_end[1]), zip(cheapest, ends, strict=True))
        runs = ((self.doubts.mutants[key[0]], key[1]) for key, _ in due)
        for outcome in replay(over or self.campaign, runs):
            looked.append((outcome.mutant, outcome.round))
            self.found[looked[-1]] = outcome
            self.campaign.progress.advance(outcome_text(outcome))
        return looked

    def _is_changed(self, key: RunId) -> bool:
        return self.found[key].verdict is not self.doubts.outcomes[key].verdict

    def _settle(self, key: RunId) -> bool:
        """Write the result of a repeat into the journal. Return whether the outcome changed."""
        first = self.doubts.outcomes[key]
        if self._is_changed(key):
            self.writer.add_outcome(unconfirmed(first, self.found[key]))
            return True
        self.times[key] += 1
        self.writer.add_outcome(replace(first, repeats=first.repeats + self.times[key]))
        return False


def choose(outcomes: Iterable[Outcome], count: int, seed: int) -> list[RunId]:
    """Return this many mutants and rounds at random, the same for equal seeds and outcomes.

    Outcomes for which no test was run are left out: there is nothing to run again.
    """
    ran = sorted(
        (outcome.mutant, outcome.round) for outcome in outcomes if outcome.tests or outcome.test is not None
    )
    return random.Random(f"{seed}:verify").sample(ran, min(count, len(ran)))


def unconfirmed(first: Outcome, second: Outcome) -> Outcome:
    """Return the outcome of a mutant whose re-run ended differently: unstable."""
    text = f"{outcome_text(first)}; run once more: {outcome_text(second)}"
    return replace(
        first, verdict=Verdict.UNSTABLE, by=None, test=second.test or first.test, message=text,
        indistinguishable=None, distance=None, divergence=(), gaps=(), way=None, compared=None,
    )  # fmt: skip


def _disagreement(mutant: Mutant, first: Outcome, second: Outcome) -> records.Disagreement:
    texts = outcome_text(first), outcome_text(second)
    if texts[0] == texts[1]:  # they differ in a later line of the message
        texts = f"{first.verdict}: {first.message}", f"{second.verdict}: {second.message}"
    return records.Disagreement(mutant.id, mutant.number, first.round, *texts)


def flaky_of(baseline: Baseline) -> records.Flaky:
    """Return the tests that are known to be flaky now, also by the runs of fork parents."""
    lines = [f"{test} in round {round + 1}: {why}" for (round, test), why in baseline.unstable.items()]
    known = sum(len(baseline.ran(round)) for round in range(len(baseline.tests)))
    return records.Flaky(tuple(lines), known + len(lines))


def refuse_flaky(request: Request, baseline: Baseline) -> None:
    """Raise UnstableError if more tests are flaky than the configuration allows."""
    flaky, limit = flaky_of(baseline), request.configuration.unstable_limit
    if flaky.share > limit:
        raise UnstableError(flaky.text(limit))
