"""One mutant of a finished campaign, run again beside what its journal says."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.taking import take_baseline
from mutabot.campaign.engines.controls import run_controls
from mutabot.campaign.engines.second_look import Looker
from mutabot.campaign.faults.providers import prepare
from mutabot.campaign.plan.second_order import pair
from mutabot.errors import SelectionError
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import Replayed
from mutabot.model import Mutant
from mutabot.model.place import Place

from .beginning import open_executor, plan_of
from .campaign import Campaign
from .request import Progress, Request


def replay_one(
    request: Request,
    journal: JournalReader,
    mutant: Mutant,
    rounds: Iterable[int],
    progress: Progress,
    also: Callable[[Campaign, Mutant], object] | None = None,
) -> list[Replayed]:
    """Run one mutant again in these rounds, beside what the journal says of it.

    ``also``: what else is to be run of it, after that.

    Raises SelectionError if the program no longer has the mutant, and what a baseline raises.
    """
    rounds = sorted(set(rounds))
    request = replace(request, rounds=rounds[-1] + 1)
    first = {(one.mutant, one.round): one for one in journal.outcomes()}
    with open_executor(request, progress) as opened:
        prepared = prepare(request.project)
        baseline, _ = take_baseline(request, opened, progress, prepared=prepared, repetitions=1)
        mutant = as_it_is_now(request, baseline, mutant)
        looker = Looker(Campaign(request, baseline, opened, progress))
        for _ in run_controls(looker.campaign, [mutant]):
            pass
        trials = [(mutant, round) for round in rounds]
        progress.stage("replay", len(trials))
        looker.run(trials)
        if also is not None:
            also(looker.campaign, mutant)
    return [
        Replayed(round, first.get((mutant.id, round)), looker.found[mutant.id, round]) for round in rounds
    ]


def as_it_is_now(request: Request, baseline: Baseline, mutant: Mutant) -> Mutant:
    """The mutant in the program as it is now: edits elsewhere move it."""
    if Place.of(mutant) in baseline.hits:
        return mutant
    planned = {one.id: one for one in plan_of(request, baseline).mutants}
    gone = next((one.id for one in mutant.singles if one.id not in planned), None)
    if gone is not None:
        problem = f"the program has changed: no test reaches {gone} any more"
        raise SelectionError(problem, unknown=[mutant.id])
    now = [planned[one.id] for one in mutant.singles]
    return pair(mutant.number, *now) if mutant.parts else replace(now[0], number=mutant.number)
