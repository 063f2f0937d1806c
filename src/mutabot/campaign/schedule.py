"""Run the mutants of a plan: which come first, with all tests or some, and until when.

Under a budget, what is expected to tell most comes first, in batches: forks share the run of the original, so
a batch gives no outcome of a survivor until that run ends. A batch is as much as is expected to end in half
of the time that is left. What is under way when the time is up is cut off, and nothing is said of it.

The whole suite judges a mutant. Where the tests that do not reach survivors, after the first that does, would
take longer than all the rest of the campaign, they are left out at first. A mutant that ends otherwise than
as a survivor after tests were left out is run with all of them before it counts. Of those that are let
through, so many are run again with the whole suite, drawn at random, as at most double the campaign. If that
notices one, all are run.

Of ladders, as few runs are made as it takes to find their thresholds. The first round of a ladder is
bisected. Each later one begins with both ends of its bracket, and is bisected where these disagree with it.
What bisection runs always fits some threshold, so it can never see a larger fault that is missed: one more
run a round, the guard, looks elsewhere. It is the largest magnitude first, then whichever was run least
often. At the first violation the whole ladder is run in all rounds. A magnitude that the robot refuses bounds
the search like one that is noticed. One that says nothing is passed over. All ladders of a campaign are
searched at once, in waves, so that one fork parent serves the faults of a round. The first round comes first;
the others, which begin with what it found, run side by side.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass, field, replace
from itertools import accumulate
from random import Random

from mutabot.campaign.campaign import Campaign, MutantRun
from mutabot.campaign.engines.engine import run_trials
from mutabot.campaign.faults.demanded import Ladders, demanded_of, split_ladders
from mutabot.campaign.plan import shuffled
from mutabot.campaign.request import REPLAY
from mutabot.campaign.reuse.keys import OutcomeWriter
from mutabot.campaign.reuse.reuse import Reused
from mutabot.config.options import in_words
from mutabot.execution.interruption import OutOfTimeError, limited
from mutabot.journal.journal import Journal
from mutabot.journal.records import BUDGET, CONFIRMATION, Budgeted, is_wrong, run_short
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.graded import MagnitudeResult, bracket_of, seen

Pair = tuple[str, int]
#: how a campaign ended whose budget was not enough
OUT_OF_TIME = "out of time"
#: runs of the first batch for each of ``-j``
_FIRST = 10
#: the share of the time left that a batch may take
_SHARE = 0.5


def run_planned(
    campaign: Campaign, mutants: Sequence[Mutant], writer: OutcomeWriter, found: Reused, started: float
) -> bool:
    """Run what is not known yet, ladders last. Returns whether that is all.

    Of ladders only what it takes to find their thresholds is run.

    Args:
        found: what is known before.
        started: when the campaign began, by ``Request.clock``.
    """
    request = campaign.request
    alone, ladders = split_ladders(mutants)
    until = None if request.budget is None else started + request.budget
    is_whole, rounds = False, range(request.rounds)
    with suppress(OutOfTimeError), limited(until, request.clock) if until is not None else nullcontext():
        if until is None:
            runs = [(one, round) for round in rounds for one in alone if (one.id, round) not in found.done]
            run_trials(campaign, runs, writer)
        else:
            _run_batches(campaign, alone, writer, found, until)
        confirm(campaign, alone, writer, found.done)
        always = demanded_of(ladders, request.configuration.demands, request.vocabulary)
        run_ladders(campaign.whole, ladders, writer, found.done, always)
        is_whole = True
    if until is not None:
        known: Budgeted = writer.journal.meta()[BUDGET]
        whole = replace(known, run=known.planned, cut_off=0) if is_whole else known
        writer.journal.set_meta(BUDGET, replace(whole, is_whole=is_whole))
        if not is_whole:
            campaign.progress.note(
                f"the budget is spent: {known.run + known.cut_off} of {known.planned} outcomes were found; "
                "`mutabot run` goes on with what is left"
            )
    return is_whole


def _run_batches(
    campaign: Campaign, mutants: Sequence[Mutant], writer: OutcomeWriter, found: Reused, until: float
) -> None:
    """Run these in batches, and keep note of how far it came."""
    request = campaign.request
    runs = in_order(mutants, request.rounds, found.done, request.seed, found.before)
    seconds = request.budget or 0.0
    left = max(until - request.clock(), 0.0)
    campaign.progress.note(f"budget: {in_words(seconds)}, of which {left:.0f} s are left")
    outcomes: list[Outcome] = []
    budgeted = Budgeted(seconds, planned=len(runs))
    done, size = 0, _FIRST * request.jobs
    try:
        while done < len(runs):
            began = request.clock()
            if began >= until:
                raise OutOfTimeError
            run_trials(campaign, runs[done : done + size], writer, outcomes.append)
            done += len(runs[done : done + size])
            budgeted = replace(budgeted, run=done - len(campaign.again))
            now = request.clock()
            size = max(request.jobs, int(size / max(now - began, 1e-3) * (until - now) * _SHARE))
    finally:
        cut_off = len(outcomes) - budgeted.run
        writer.journal.set_meta(BUDGET, replace(budgeted, cut_off=cut_off))


def in_order(
    mutants: Sequence[Mutant],
    rounds: int,
    done: Iterable[Pair],
    seed: int,
    before: Mapping[Pair, Verdict],
) -> list[MutantRun]:
    """All that is not done, what is expected to tell most first, one round after the other.

    Among those that are expected to tell alike much, the order depends on the seed and the mutants' ids
    alone. ``before``: what outcomes were that do not hold any more.
    """
    firsts: dict[tuple[str, object], str] = {}
    for mutant in shuffled(mutants, f"{seed}:site"):
        firsts.setdefault((mutant.family, mutant.site), mutant.id)
    first_ids, done = set(firsts.values()), set(done)

    def rank(run: MutantRun) -> int:
        mutant, round = run
        verdict = before.get((mutant.id, round))
        if verdict is None:
            return 0 if mutant.id in first_ids else 1
        if verdict.is_valid and not verdict.is_killed:
            return 2
        return 3 if mutant.id in first_ids else 4

    return [
        run
        for round in range(rounds)
        for run in sorted(((one, round) for one in shuffled(mutants, f"{seed}:budget:{round}")), key=rank)
        if (run[0].id, round) not in done
    ]


# Tests that are left out at first

#: seconds of tests below which nothing is left out
LEAST = 30.0
#: the share of mutants that are taken to survive, before any has run. To leave out tests saves time for these
#: alone: most of the others end early, and those that do not are run twice
SURVIVORS = 1 / 3


def earlier_decision(journal: Journal) -> bool | None:
    """What was decided in the campaign that this one goes on with; None if that had come to its end."""
    return journal.meta().get(CONFIRMATION) if journal.finished != "complete" else None


def decide(campaign: Campaign, mutants: Sequence[Mutant], journal: Journal, earlier: bool | None) -> Campaign:
    """The campaign with or without the tests that are left out at first. The journal says which.

    This goes by what the tests took in the baseline, and by how many mutants are taken to survive.
    ``earlier``: what this campaign has decided before it was interrupted.
    """
    short = replace(campaign, is_short=not campaign.request.every_test)
    alone, _ = split_ladders(mutants)  # a search goes by what it finds: it needs the whole suite
    without, rest = _fixed(campaign), 0.0
    for round in range(campaign.request.rounds):
        walls = [campaign.baseline.ends[round, test].wall for test in campaign.baseline.suite(round)]
        until = [0.0, *accumulate(walls)]
        for numbers in filter(None, short.reaching(alone, round).values()):
            reaching = sum(walls[number] for number in numbers)
            without += reaching
            rest += until[-1] - until[numbers[0]] - reaching
    is_short = rest * SURVIVORS > max(without, LEAST) if earlier is None else earlier and short.is_short
    journal.set_meta(CONFIRMATION, is_short)
    return replace(campaign, is_short=is_short)


def confirm(
    campaign: Campaign,
    mutants: Sequence[Mutant],
    writer: OutcomeWriter,
    done: Collection[tuple[str, int]] = (),
) -> None:
    """Run with the whole suite what counts with that only, and a sample of what was let through without it.

    If it notices one of these, all of them are run. ``done``: ids and rounds of outcomes that were known
    before this campaign.

    Raises ControlError for a control that ends wrongly.
    """
    by_id = {mutant.id: mutant for mutant in mutants}
    found = [one for one in writer.journal.outcomes() if one.mutant in by_id]
    drawn = run_short(found, campaign.request.seed)
    left = [one for one in drawn if not one.confirmed]
    again = list(campaign.again)
    campaign.again.clear()
    spent = _fixed(campaign)
    spent += sum(one.wall for one in (*found, *again) if (one.mutant, one.round) not in done)
    due = left if any(map(is_wrong, drawn)) else list(_affordable(campaign, by_id, left, spent))
    if left:
        campaign.progress.note(
            f"{len(left)} mutants were let through without tests that do not reach them; {len(due)} of these "
            "are run with the whole suite as well"
        )

    def run(some: Iterable[Outcome], let_through: Iterable[Outcome]) -> int:
        ended: list[Outcome] = []
        confirmed = {(one.mutant, one.round) for one in let_through}
        runs = [(by_id[one.mutant], one.round) for one in some]
        run_trials(campaign.whole, runs, writer, ended.append, confirmed)
        return sum(map(is_wrong, ended))

    wrong = run([*again, *due], due)
    if wrong and len(due) < len(left):
        campaign.progress.note(
            f"{wrong} of them ended otherwise with the whole suite, so all are run with it"
        )
        run(left[len(due) :], left)


def _affordable(
    campaign: Campaign, mutants: Mapping[str, Mutant], left: Iterable[Outcome], seconds: float
) -> Iterator[Outcome]:
    """The first of these that take so many seconds with the whole suite, and one at least."""
    baseline = campaign.baseline
    rounds: set[int] = set()
    for number, one in enumerate(left):
        is_fresh, suite = one.engine == REPLAY, baseline.suite(one.round)
        tests = suite if is_fresh else baseline.tests_judging(one.round, mutants[one.mutant])
        seconds -= baseline.seconds(one.round, tests) + (baseline.startup if is_fresh else 0.0)
        if not is_fresh and one.round not in rounds:  # the original runs beside them
            seconds -= baseline.seconds(one.round, suite)
        rounds.add(one.round)
        if seconds < 0 and number:
            return
        yield one


def _fixed(campaign: Campaign) -> float:
    """Seconds that a campaign takes for the original alone, in all its runs."""
    request, baseline = campaign.request, campaign.baseline
    rounds = range(request.rounds)
    once = sum(baseline.seconds(round, baseline.suite(round)) for round in rounds)
    return once * (request.repetitions + request.forks)


# Ladders

#: indices of a ladder's magnitudes, from the smallest
Step = int


@dataclass(slots=True)
class LadderSearch:
    """The search on one ladder.

    Attributes:
        size: how many magnitudes it has.
        rounds: how many rounds there are.
        seed: breaks ties among guards.
        always: magnitudes that are run in every round, such as those that are demanded.
        found: what was seen, by round and step.
    """

    size: int
    rounds: int
    seed: int = 0
    always: frozenset[Step] = frozenset()
    found: dict[int, dict[Step, MagnitudeResult]] = field(default_factory=dict)
    _guards: set[int] = field(default_factory=set)

    def take(self, round: int, step: Step, seen: MagnitudeResult) -> None:
        """A magnitude was run in a round."""
        self.found.setdefault(round, {})[step] = seen

    @property
    def is_violated(self) -> bool:
        """Whether any round missed a larger fault where it noticed a smaller one."""
        rows = ({float(step): one for step, one in row.items()} for row in self.found.values())
        return any(bracket_of(row).is_violated for row in rows)

    def due(self, round: int) -> set[Step]:
        """The magnitudes to run next in a round; empty if nothing more is asked there."""
        row = self.found.get(round, {})
        left = set(range(self.size)) - row.keys()
        if self.is_violated:
            return left
        always = self.always & left
        if always:
            return set(always)
        ends = {step for step in self._guess(round) if 0 <= step < self.size}
        wanted = (ends - row.keys()) or _middle(row, *_ends(row, self.size))
        if wanted:
            return wanted & left
        return self._guard(round, row, left)

    def _guess(self, round: int) -> tuple[Step, ...]:
        """Both ends of the bracket of the first round; none in that round itself, or if it knows nothing."""
        row = self.found.get(0, {})
        if round == 0 or not any(one.is_valid for one in row.values()):
            return ()
        return _ends(row, self.size)

    def _guard(self, round: int, row: Mapping[Step, MagnitudeResult], left: set[Step]) -> set[Step]:
        """One magnitude more, the first time that nothing else is left to ask."""
        if round in self._guards or not left:
            return set()
        self._guards.add(round)
        runs = Counter(step for other in self.found.values() for step in other)
        ties = Random(f"{self.seed}:{round}").random()
        largest = self.size - 1
        if largest in left and not runs[largest]:
            return {largest}
        least = min(runs[step] for step in left)
        fewest = sorted(step for step in left if runs[step] == least)
        return {fewest[int(ties * len(fewest))]}


def _ends(row: Mapping[Step, MagnitudeResult], size: int) -> tuple[Step, Step]:
    """The largest step that was missed, and the smallest above it that was noticed or refused.

    −1 and ``size`` where there is none.
    """
    low = max((step for step, one in row.items() if one is MagnitudeResult.MISSED), default=-1)
    bounds = (MagnitudeResult.NOTICED, MagnitudeResult.REFUSED)
    high = min((step for step, one in row.items() if one in bounds and step > low), default=size)
    return low, high


def _middle(row: Mapping[Step, MagnitudeResult], low: Step, high: Step) -> set[Step]:
    """The step in the middle between two, of those that were not run; none if all were."""
    between = [step for step in range(low + 1, high) if step not in row]
    return {between[len(between) // 2]} if between else set()


def run_ladders(
    campaign: Campaign,
    ladders: Ladders,
    writer: OutcomeWriter,
    done: Collection[tuple[str, int]],
    always: Mapping[str, Collection[float]],
) -> None:
    """Find the thresholds; every outcome is in the journal within a second.

    ``done`` are the ids and rounds whose outcomes the journal holds already. ``always`` gives magnitudes that
    are run in every round, by ladder.

    Raises ControlError for a control that ends wrongly.
    """
    if not ladders:
        return
    kept = {
        (one.mutant, one.round): one for one in writer.journal.outcomes() if (one.mutant, one.round) in done
    }
    request, searches = campaign.request, dict[str, LadderSearch]()
    for name, mutants in ladders.items():
        demanded = always.get(name, ())
        steps = frozenset(step for step, one in enumerate(mutants) if one.magnitude in demanded)
        searches[name] = LadderSearch(len(mutants), request.rounds, request.seed, steps)
    found: list[Outcome] = []

    def run(known: range) -> None:
        """Run until nothing more is asked in these rounds; a violation asks in all of them."""
        while trials := [
            (searches[name], step, mutants[step], round)
            for round in known
            for name, mutants in ladders.items()
            for step in sorted(searches[name].due(round))
        ]:
            found.clear()
            new = [(mutant, round) for *_, mutant, round in trials if (mutant.id, round) not in kept]
            run_trials(campaign, new, writer, found.append)
            ended = {**kept, **{(one.mutant, one.round): one for one in found}}
            for search, step, mutant, round in trials:
                outcome = ended.get((mutant.id, round))
                if outcome is not None:
                    search.take(round, step, seen(outcome))

    rounds = range(request.rounds)
    run(rounds[:1])
    run(rounds)
    whole = len(rounds) * sum(map(len, ladders.values()))
    runs = sum(len(row) for search in searches.values() for row in search.found.values())
    campaign.progress.note(
        f"thresholds: {len(ladders)} ladders in {len(rounds)} rounds took {runs} runs; all their magnitudes "
        f"would have taken {whole}"
    )
