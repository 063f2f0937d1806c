"""Which kills may be mere chance: those by tests that cannot be known to end alike in equal runs.

A test in simulated time whose runs of the original are equal to the last bit is taken to be deterministic. Of
any other test a kill is in doubt if the test is known to be unreliable, or if it kills so few of the mutants
that it judges that it might do so by failing at random. A survivor is in doubt where its operator leaves to
chance what happens.

A second look: do outcomes come out the same in fresh processes, and can the tests be relied on?

``--verify N`` runs outcomes chosen at random once more by replay, the reference, and compares how they end.
What is in doubt is run again by ``repeats``.

Repeats: kills that may be chance are run once more, and what ``--verify`` asks for.

A kill that does not come out again becomes ``unstable``. If one of a test's kills does not, all its other
kills are in doubt as well. Kills in doubt are repeated cheapest first, within a small share of the campaign's
time, and a larger one as soon as one does not come out again; how many were left is told.

Suspects: tests that passed in the baseline and failed in a trunk.

A trunk runs the suite as the baseline did, so such a test may be flaky; or something that a branch left
behind made it fail. One more run without branches tells: a test that fails again is flaky and judges nothing.
Of one that passes, that cannot be told apart, so its kills are repeated.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.taking import FAILS
from mutabot.campaign.campaign import Campaign, Sink
from mutabot.campaign.engines.engine import Trial
from mutabot.campaign.engines.fresh import replay
from mutabot.campaign.faults.providers import provider
from mutabot.campaign.request import Progress, Request
from mutabot.errors import UnstableError
from mutabot.execution.task import Task
from mutabot.journal.records import (
    FLAKY,
    REPEATS,
    VERIFICATION,
    Disagreement,
    Flaky,
    Repeated,
    Repeats,
    Verification,
)
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.codec import to_data
from mutabot.model.outcome import in_words, same_end

#: a mutant in a round
Key = tuple[str, int]
#: so many kills of a test, or this share of what it judges, could be failures at random
_FEW, _SHARE = 2, 0.1


@dataclass(slots=True)
class Doubts:
    """What is in doubt in a campaign.

    Attributes:
        baseline: what is known about the tests.
        mutants: by id.
        outcomes: by mutant and round.
        unreliable: tests that have been seen to end otherwise in equal runs, in any round.
    """

    baseline: Baseline
    mutants: Mapping[str, Mutant]
    outcomes: Mapping[Key, Outcome]
    unreliable: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.unreliable.update(self.baseline.doubted, (test for _, test in self.baseline.unequal))
        self.unreliable.update(
            test for (_, test), why in self.baseline.unstable.items() if not why.startswith(FAILS)
        )

    def kills(self) -> list[Key]:
        """All kills by a test that ended."""
        return [key for key, one in self.outcomes.items() if one.verdict is Verdict.KILLED and one.test]

    def in_doubt(self) -> list[Key]:
        """The kills that may be chance and have not been repeated yet."""
        kills = [key for key in self.kills() if not self.outcomes[key].repeats]
        few = self._few_lone_kills()
        return [key for key in kills if self._test(key) in self.unreliable or key in few]

    def raced(self) -> list[Key]:
        """Kills and survivors whose operator leaves to chance what happens, not repeated yet."""
        return [
            key
            for key, one in self.outcomes.items()
            if one.verdict in (Verdict.KILLED, Verdict.SURVIVED) and not one.repeats
            if self._is_raced(self.mutants[key[0]])
        ]

    def _is_raced(self, mutant: Mutant) -> bool:
        return provider(mutant.provider).is_raced(mutant.operator)

    def is_certain(self, key: Key) -> bool:
        """Whether a kill was repeated before, or is one by a test that is taken to be deterministic."""
        test = self._test(key)
        if self.outcomes[key].repeats:
            return True
        return test not in self.unreliable and self._has_clock(test, key[1])

    def _few_lone_kills(self) -> set[Key]:
        """Kills of a mutant in one round alone, by a test without a clock that has few such kills."""
        times = Counter((mutant, self._test((mutant, round))) for mutant, round in self.kills())
        lone: dict[str, list[Key]] = {}
        for key in self.kills():
            test = self._test(key)
            if times[key[0], test] == 1 and not self._has_clock(test, key[1]):
                lone.setdefault(test, []).append(key)
        judged = self._judged(lone)
        return {
            key
            for test, keys in lone.items()
            if len(keys) < judged[test] and len(keys) <= max(_FEW, _SHARE * judged[test])
            for key in keys
        }

    def _judged(self, tests: Iterable[str]) -> Counter[str]:
        """How many outcomes each of these tests has had a say in."""
        counts: Counter[str] = Counter()
        wanted = set(tests)
        for key, outcome in self.outcomes.items() if wanted else ():
            counts.update(wanted.intersection(self._judging(key, outcome)))
        return counts

    def _judging(self, key: Key, outcome: Outcome) -> list[str]:
        """The tests that have had a say in an outcome: of those that ran, all that reach the mutant."""
        judges = self.baseline.tests_reaching(key[1], self.mutants[key[0]])
        return [test for test in self._ran(key, outcome) if test in judges or test == outcome.test]

    def _ran(self, key: Key, outcome: Outcome) -> tuple[str, ...]:
        suite = self.baseline.suite(key[1])
        if outcome.test in suite and not outcome.complete:
            return suite[: suite.index(outcome.test) + 1]
        return suite if outcome.tests else ()

    def cost(self, key: Key) -> float:
        """Seconds that the tests of a repeat take on the original."""
        ends, round = self.baseline.ends, key[1]
        return sum(ends[round, test].wall for test in self._ran(key, self.outcomes[key]))

    def _test(self, key: Key) -> str:
        return self.outcomes[key].test or ""

    def _has_clock(self, test: str, round: int) -> bool:
        end = self.baseline.ends.get((round, test))
        return end is not None and end.simulated is not None


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


#: repeats of kills in doubt may take this share of the time that the campaign has taken, or so many seconds
SHARE, SECONDS = 0.05, 2.0
#: the same once a kill has not come out again, and for what is left to chance
MOST_SHARE, MOST_SECONDS = 0.2, 10.0
#: how often an outcome is repeated whose operator leaves to chance what happens
RACES = 3


def look_again(campaign: Campaign, mutants: Sequence[Mutant], sink: Sink, spent: float) -> None:
    """Verify and repeat, and write down what came of it, flaky tests included.

    ``spent``: seconds that the campaign has taken until now.
    """
    request, baseline, progress = campaign.request, campaign.baseline, campaign.progress
    journal = sink.journal
    journal.set_meta(FLAKY, to_data(flaky_of(baseline)))
    by_id = {mutant.id: mutant for mutant in mutants}
    outcomes = {(one.mutant, one.round): one for one in journal.outcomes() if one.mutant in by_id}
    looker = Looker(campaign)
    second = _SecondLook(Doubts(baseline, by_id, outcomes), looker, sink, progress)
    chosen = choose(outcomes.values(), request.verify, request.seed)
    second.run(chosen)
    if request.verify:
        found = [disagreement(by_id[key[0]], outcomes[key], looker.found[key]) for key in chosen]
        verification = Verification(request.verify, len(chosen), tuple(one for one in found if one))
        journal.set_meta(VERIFICATION, to_data(verification))
        progress.note(f"verify: {verification.agreed} of {verification.checked} outcomes agree")
    if request.repeats:
        most = max(MOST_SHARE * spent, MOST_SECONDS)
        second.repeat_raced(most)
        second.repeat_doubted(max(SHARE * spent, SECONDS), most)
    journal.set_meta(REPEATS, to_data(second.repeats()))


@dataclass(slots=True)
class _SecondLook:
    """The repeats of one campaign."""

    doubts: Doubts
    looker: Looker
    sink: Sink
    progress: Progress

    def run(self, keys: Iterable[Key], until: float | None = None) -> None:
        """Run these once more, as far as ``until`` (``Request.clock``) allows."""
        trials: list[Trial] = [(self.doubts.mutants[mutant], round) for mutant, round in keys]
        self.looker.look(trials, until)

    def repeat_raced(self, seconds: float) -> None:
        """Run what chance decides several times more; what does not always end alike becomes unstable."""
        until = self.looker.campaign.request.clock() + seconds
        keys = sorted(self.doubts.raced(), key=self.doubts.cost)
        due, changed, looked = list(keys), list[Key](), set[Key]()
        for again in range(RACES):
            for key in due:
                self.looker.found.pop(key, None)
            self.run(due, until)
            due = [key for key in due if key in self.looker.found]
            looked.update(due)
            for key in due:
                first = self.doubts.outcomes[key]
                if self._is_changed(key):
                    changed.append(key)
                    self.sink.add_outcome(unconfirmed(first, self.looker.found[key]))
                else:
                    self.sink.add_outcome(replace(first, repeats=first.repeats + again + 1))
            due = [key for key in due if key not in changed]
        if keys:
            left = f"; {len(keys) - len(looked)} were left" if len(looked) < len(keys) else ""
            again = len(looked) - len(changed)
            self.progress.note(
                f"repeats: {again} of {len(looked)} ends left to chance are always alike{left}"
            )

    def repeat_doubted(self, seconds: float, most: float) -> None:
        """Run the kills in doubt once more, and those which that puts in doubt.

        This takes so many ``seconds``, and at ``most`` as many if one does not come out again.
        """
        began = self.looker.campaign.request.clock()
        raced = set(self.doubts.raced())
        repeated: list[Key] = []
        changed: list[Key] = []
        while due := [key for key in self.doubts.in_doubt() if key not in raced.union(repeated)]:
            new = sorted((key for key in due if key not in self.looker.found), key=self.doubts.cost)
            seconds = max(seconds, most) if changed else seconds
            self.run(new, began + seconds)
            looked = [key for key in due if key in self.looker.found]
            if not looked:
                break
            repeated += looked
            changed += self._settle(looked)
            self.doubts.unreliable.update(self.doubts.outcomes[key].test or "" for key in changed)
        if repeated or due:
            left = f"; {len(due)} were left, as repeats may take {seconds:.0f} s" if due else ""
            again = len(repeated) - len(changed)
            self.progress.note(f"repeats: {again} of {len(repeated)} kills in doubt come out again{left}")

    def repeats(self) -> Repeats:
        """What is known now."""
        doubts = self.doubts
        kills = doubts.kills()
        certain = {key for key in kills if key not in self.looker.found and doubts.is_certain(key)}
        doubted = set(doubts.in_doubt())
        others = [key for key in kills if key not in certain and key not in doubted]
        survivors = [key for key, one in doubts.outcomes.items() if one.verdict is Verdict.SURVIVED]
        return Repeats(
            self._stratum(doubted - certain), self._stratum(others), len(certain), self._stratum(survivors)
        )

    def _stratum(self, keys: Iterable[Key]) -> Repeated:
        keys = list(keys)
        looked = [key for key in keys if key in self.looker.found]
        return Repeated(len(keys), len(looked), sum(map(self._is_changed, looked)))

    def _is_changed(self, key: Key) -> bool:
        return self.looker.found[key].verdict is not self.doubts.outcomes[key].verdict

    def _settle(self, keys: Iterable[Key]) -> list[Key]:
        """Write into the journal what their repeats say; returns those that came out otherwise."""
        changed = []
        for key in keys:
            first, second = self.doubts.outcomes[key], self.looker.found[key]
            if self._is_changed(key):
                changed.append(key)
                self.sink.add_outcome(unconfirmed(first, second))
            else:
                self.sink.add_outcome(replace(first, repeats=first.repeats + 1))
        return changed


#: seconds for a test of the suite without any mutant
_DEADLINE = 600.0


def clear_up(campaign: Campaign, suspects: Iterable[tuple[int, str]]) -> None:
    """Run the suite once more in each round that has suspects, and note in the baseline what they are."""
    request, baseline, progress = campaign.request, campaign.baseline, campaign.progress
    by_round: dict[int, list[str]] = {}
    for round, test in suspects:
        by_round.setdefault(round, []).append(test)
    tasks = [
        Task(round, request.job(round, tests=baseline.suite(round)), deadline=_DEADLINE) for round in by_round
    ]
    for result in campaign.executor.run(tasks):
        round = result.task.key
        ends = ((end, baseline.ends[round, end.test]) for end in result.ends)
        passed = {end.test for end, first in ends if end.lasting == first.lasting}
        for test in by_round[round]:
            if test not in passed:
                baseline.set_aside(round, test, "passed in the baseline, but not in equal runs")
                progress.note(f"set aside as flaky in round {round + 1}: {test}")
            else:
                baseline.doubt(test)
                progress.note(
                    f"{test} failed once while mutants were branched off in round {round + 1}, and passes "
                    "without: by chance, or by what a branch left behind; mutants of this test and of later "
                    "ones run in processes of their own"
                )
