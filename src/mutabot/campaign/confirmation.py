"""Confirm with the whole suite the outcomes of mutants that ran without some of its tests.

The whole suite judges a mutant. Where the tests that do not reach survivors, after the first that does, would
take longer than all the rest of the campaign, they are left out at first. A mutant that ends otherwise than
as a survivor after tests were left out is run with all of them before it counts. Of those that are let
through, a random sample that at most doubles the campaign is run again with the whole suite. If that
notices one, all are run.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate
from typing import TYPE_CHECKING

from mutabot.campaign.engines.engine import run_trials
from mutabot.config.options import REPLAY
from mutabot.journal.records import CONFIRMATION, is_wrong, run_short
from mutabot.thresholds.planned import split_ladders

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign
    from mutabot.campaign.reuse.keys import OutcomeWriter
    from mutabot.journal.journal import Journal
    from mutabot.model import Mutant, Outcome

#: seconds of tests below which nothing is left out
LEAST = 30.0
#: the share of mutants that are taken to survive, before any has run. To leave out tests saves time for these
#: alone: most of the others end early, and those that do not are run twice
SURVIVORS = 1 / 3


def earlier_decision(journal: Journal) -> bool | None:
    """Return whether the campaign that this one continues left out tests; None if that one was complete."""
    return journal.meta().get(CONFIRMATION) if journal.finished != "complete" else None


def leave_tests_out(
    campaign: Campaign, mutants: Sequence[Mutant], journal: Journal, earlier: bool | None
) -> Campaign:
    """Decide whether some tests are left out at first, note that in the journal, and return the campaign.

    This goes by what the tests took in the baseline, and by how many mutants are taken to survive.
    ``earlier``: what this campaign has decided before it was interrupted.
    """
    short = replace(campaign, is_short=not campaign.request.every_test)
    alone, _ = split_ladders(mutants)  # a search goes by what it finds: it needs the whole suite
    without, rest = _original_seconds(campaign), 0.0
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
    """Re-run with the whole suite the outcomes that need it, and a sample of the survivors that do not.

    If it notices one of these, all of them are run. ``done``: ids and rounds of outcomes that were known
    before this campaign.

    Raises ControlError for a control that ends wrongly.
    """
    by_id = {mutant.id: mutant for mutant in mutants}
    found = [outcome for outcome in writer.journal.outcomes() if outcome.mutant in by_id]
    drawn = run_short(found, campaign.request.seed)
    left = [outcome for outcome in drawn if not outcome.confirmed]
    again = list(campaign.again)
    campaign.again.clear()
    spent = _original_seconds(campaign)
    spent += sum(outcome.wall for outcome in (*found, *again) if (outcome.mutant, outcome.round) not in done)
    due = left if any(map(is_wrong, drawn)) else list(_affordable(campaign, by_id, left, spent))
    if left:
        campaign.progress.note(
            f"{len(left)} mutants were let through without tests that do not reach them; {len(due)} of these "
            "are run with the whole suite as well"
        )

    def run(some: Iterable[Outcome], let_through: Iterable[Outcome]) -> int:
        ended: list[Outcome] = []
        confirmed = {(outcome.mutant, outcome.round) for outcome in let_through}
        runs = [(by_id[outcome.mutant], outcome.round) for outcome in some]
        run_trials(campaign.whole, runs, writer, ended.append, confirmed)
        return sum(map(is_wrong, ended))

    wrong = run([*again, *due], due)
    if wrong and len(due) < len(left):
        campaign.progress.note(f"{wrong} of them changed with the whole suite, so all are run with it")
        run(left[len(due) :], left)


def _affordable(
    campaign: Campaign, mutants: Mapping[str, Mutant], left: Iterable[Outcome], seconds: float
) -> Iterator[Outcome]:
    """Yield the first outcomes whose re-runs with the whole suite fit into the time; at least one."""
    baseline = campaign.baseline
    rounds: set[int] = set()
    for number, outcome in enumerate(left):
        is_fresh, suite = outcome.engine == REPLAY, baseline.suite(outcome.round)
        tests = suite if is_fresh else baseline.tests_from_first_reach(outcome.round, mutants[outcome.mutant])
        seconds -= baseline.seconds(outcome.round, tests) + (baseline.startup if is_fresh else 0.0)
        if not is_fresh and outcome.round not in rounds:  # the original runs beside them
            seconds -= baseline.seconds(outcome.round, suite)
        rounds.add(outcome.round)
        if seconds < 0 and number:
            return
        yield outcome


def _original_seconds(campaign: Campaign) -> float:
    """Return the time (s) that a campaign takes for the original alone, in all its runs."""
    request, baseline = campaign.request, campaign.baseline
    rounds = range(request.rounds)
    once = sum(baseline.seconds(round, baseline.suite(round)) for round in rounds)
    return once * (request.repetitions + request.forks)
