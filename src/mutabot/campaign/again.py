"""Run one mutant of a finished campaign again, beside what its journal says."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.taking import take_baseline
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.controls import run_controls
from mutabot.campaign.engines.engine import replay
from mutabot.campaign.faults.providers import prepare
from mutabot.campaign.plan import make_plan
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.run import open_executor
from mutabot.errors import SelectionError
from mutabot.journal.journal import JournalReader
from mutabot.journal.records import Replayed
from mutabot.model import Mutant
from mutabot.model.mutant import Place
from mutabot.model.outcome import in_words


def replay_one(
    request: Request, journal: JournalReader, mutant: Mutant, rounds: Iterable[int], progress: Progress
) -> list[Replayed]:
    """Run one mutant again in these rounds, beside what the journal says of it.

    Raises what ``anew`` raises.
    """
    rounds = sorted(set(rounds))
    first = {(one.mutant, one.round): one for one in journal.outcomes()}
    with anew(request, mutant, rounds[-1], progress) as (campaign, now):
        for _ in run_controls(campaign, [now]):
            pass
        progress.stage("replay", len(rounds))
        second = {}
        for outcome in replay(campaign, [(now, round) for round in rounds]):
            second[outcome.round] = outcome
            progress.advance(in_words(outcome))
    return [Replayed(round, first.get((now.id, round)), second[round]) for round in rounds]


@contextmanager
def anew(
    request: Request, mutant: Mutant, last: int, progress: Progress
) -> Iterator[tuple[Campaign, Mutant]]:
    """The campaign with a baseline taken anew up to a round, and the mutant in the program as it is now.

    Raises SelectionError if the program no longer has the mutant, and what a baseline raises.
    """
    request = replace(request, rounds=last + 1)
    with open_executor(request, progress) as opened:
        prepared = prepare(request.project)
        baseline, _ = take_baseline(request, opened, progress, prepared=prepared, repetitions=1)
        yield Campaign(request, baseline, opened, progress), as_it_is_now(request, baseline, mutant)


def as_it_is_now(request: Request, baseline: Baseline, mutant: Mutant) -> Mutant:
    """The mutant in the program as it is now: edits elsewhere move it."""
    if Place.of(mutant) in baseline.hits:
        return mutant
    planned = {one.id: one for one in make_plan(baseline, request.project).mutants}
    if mutant.id not in planned:
        problem = f"the program has changed: no test reaches {mutant.id} any more"
        raise SelectionError(problem)
    return replace(planned[mutant.id], number=mutant.number)
