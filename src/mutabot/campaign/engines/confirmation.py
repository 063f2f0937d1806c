"""Confirmation: does the whole suite say the same of mutants that were run without some of its tests?

The whole suite judges a mutant. Where the tests that do not reach one, after the first that does, would take
longer than all the rest of the campaign, they are left out at first. A mutant that ends otherwise than as a
survivor after tests were left out is run with all of them before it counts. Of those that are let through, so
many are run again with the whole suite, drawn at random, as at most double the campaign. If that notices one,
all are run.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import accumulate

from mutabot.campaign.campaign import Campaign, Sink
from mutabot.campaign.faults.demanded import apart
from mutabot.journal.journal import Journal
from mutabot.journal.records import CONFIRMATION, LET_THROUGH, Confirmation, is_wrong, run_short
from mutabot.model import Mutant, Outcome
from mutabot.model.codec import from_data, to_data

from .choice import first_engine, repetitions_for, run_trials
from .fresh import REPLAY

#: seconds of tests below which nothing is left out
LEAST = 30.0


def earlier_decision(journal: Journal) -> Confirmation | None:
    """What was decided in the campaign that this one goes on with; None if that had come to its end."""
    said = journal.meta().get(CONFIRMATION) if journal.finished != "complete" else None
    return from_data(Confirmation, said) if said is not None else None


def decide(
    campaign: Campaign, mutants: Sequence[Mutant], journal: Journal, earlier: Confirmation | None
) -> Campaign:
    """The campaign with or without the tests that are left out at first; the journal says which.

    Decided by what the tests took in the baseline, as if every mutant survived: then it is too much at most.
    ``earlier``: what this campaign has decided before it was interrupted.
    """
    short = replace(campaign, is_short=not campaign.request.every_test)
    alone, _ = apart(mutants)  # a search goes by what it finds: it needs the whole suite
    without, rest = _fixed(campaign), 0.0
    for round in range(campaign.request.rounds):
        walls = [campaign.baseline.ends[round, test].wall for test in campaign.baseline.suite(round)]
        until = [0.0, *accumulate(walls)]
        for numbers in filter(None, short.reaching(alone, round).values()):
            reaching = sum(walls[number] for number in numbers)
            without += reaching
            rest += until[-1] - until[numbers[0]] - reaching
    is_short = rest > max(without, LEAST) if earlier is None else earlier.is_short and short.is_short
    journal.set_meta(CONFIRMATION, to_data(Confirmation(is_short, rest, without)))
    return replace(campaign, is_short=is_short)


def confirm(
    campaign: Campaign, mutants: Sequence[Mutant], sink: Sink, done: Collection[tuple[str, int]] = ()
) -> None:
    """Run with the whole suite what counts with that only, and a sample of what was let through without it.

    If it notices one of these, all of them are run. ``done`` are the ids and rounds of outcomes that were
    known before this campaign.

    Raises ControlError for a control that ends wrongly.
    """
    by_id = {mutant.id: mutant for mutant in mutants}
    found = [one for one in sink.journal.outcomes() if one.mutant in by_id]
    drawn = run_short(found, campaign.request.seed)
    left = [one for one in drawn if not one.confirmed]
    again = list(campaign.again)
    campaign.again.clear()
    seconds = _fixed(campaign) + sum(_cost(campaign, by_id[one.mutant], one) for one in again)
    seconds += sum(one.wall for one in [*found, *again] if (one.mutant, one.round) not in done)
    due = left if any(map(is_wrong, drawn)) else list(_affordable(campaign, by_id, left, seconds))
    if left:
        campaign.progress.note(
            f"{len(left)} mutants were let through without tests that do not reach them; {len(due)} of these "
            "are run with the whole suite as well"
        )
    wrong = _run(campaign, by_id, again, due, sink)
    if wrong and len(due) < len(left):
        campaign.progress.note(
            f"{wrong} of them ended otherwise with the whole suite, so all are run with it"
        )
        _run(campaign, by_id, (), left[len(due) :], sink)


def _run(
    campaign: Campaign, by_id: dict[str, Mutant], again: Iterable[Outcome], due: Iterable[Outcome], sink: Sink
) -> int:
    """Run these with the whole suite; returns how many of the second it notices."""
    ended: list[Outcome] = []
    trials = [(by_id[one.mutant], one.round) for one in (*again, *due)]
    run_trials(campaign.whole, trials, sink, ended.append, {(one.mutant, one.round) for one in due})
    return sum(map(is_wrong, ended))


def _affordable(
    campaign: Campaign, by_id: dict[str, Mutant], left: Iterable[Outcome], seconds: float
) -> Iterator[Outcome]:
    """The first of these that take so many seconds, and one at least."""
    rounds: set[int] = set()
    for number, one in enumerate(left):
        seconds -= _cost(campaign, by_id[one.mutant], one)
        if one.engine != REPLAY and one.round not in rounds:  # the original runs beside them
            seconds -= _seconds(campaign, [(one.round, campaign.baseline.suite(one.round))])
        rounds.add(one.round)
        if seconds < 0 and number:
            return
        yield one


def _cost(campaign: Campaign, mutant: Mutant, outcome: Outcome) -> float:
    """Seconds that a mutant takes with the whole suite, up to the test that has decided, if one has."""
    baseline, round = campaign.baseline, outcome.round
    is_fresh = outcome.engine == REPLAY
    tests = baseline.suite(round) if is_fresh else baseline.tests_judging(round, mutant)
    last = tests.index(outcome.test) + 1 if outcome.test in tests else len(tests)
    last = len(tests) if outcome.verdict in LET_THROUGH else last
    return _seconds(campaign, [(round, tests[:last])]) + (baseline.startup if is_fresh else 0.0)


def _fixed(campaign: Campaign) -> float:
    """Seconds that a campaign takes for the original alone, in all its runs."""
    suites = [(round, campaign.baseline.suite(round)) for round in range(campaign.request.rounds)]
    runs = repetitions_for(campaign.request) + (first_engine(campaign.request).name != REPLAY)
    return runs * _seconds(campaign, suites)


def _seconds(campaign: Campaign, tests: Iterable[tuple[int, Iterable[str]]]) -> float:
    """What tests took in the baseline."""
    ends = campaign.baseline.ends
    return sum(ends[round, test].wall for round, some in tests for test in some)
