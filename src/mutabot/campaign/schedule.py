"""Run the mutants of a plan in a useful order, until all are done or time is up.

Under a budget, the most informative runs come first, in batches: forks share the run of the original, so
a batch gives no outcome of a survivor until that run ends. A batch is as much as is expected to end in half
of the time that is left. What is under way when the time is up is cut off, and nothing is said of it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import nullcontext, suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from mutabot.campaign.baseline.seeds import record_more_seeds
from mutabot.campaign.engines.engine import run_trials
from mutabot.campaign.faults.providers import provider
from mutabot.campaign.plan import shuffled
from mutabot.config.options import duration_text
from mutabot.errors import plural
from mutabot.execution.interruption import OutOfTimeError, limited
from mutabot.journal.records import BUDGET, Budgeted
from mutabot.thresholds.planned import demanded_of, split_ladders
from mutabot.thresholds.search import search_ladders

from .confirmation import confirm

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign, MutantRun, RunId
    from mutabot.campaign.reuse.keys import OutcomeWriter
    from mutabot.campaign.reuse.reuse import Reused
    from mutabot.model import Mutant, Outcome, Verdict
    from mutabot.thresholds.planned import Ladders

#: how a campaign ended whose budget was not enough
OUT_OF_TIME = "out of time"
#: runs of the first batch for each of ``-j``
_FIRST = 10
#: the share of the time left that a batch may take
_SHARE = 0.5


def run_planned(
    campaign: Campaign, mutants: Sequence[Mutant], writer: OutcomeWriter, found: Reused, started: float
) -> bool:
    """Run what is not known yet, ladders last. Return whether everything was run.

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
        record_more_seeds(
            campaign,
            [mutant for mutant in alone if any((mutant.id, round) not in found.done for round in rounds)],
        )
        if until is None:
            runs = [
                (mutant, round)
                for round in rounds
                for mutant in alone
                if (mutant.id, round) not in found.done
            ]
            run_trials(campaign, runs, writer)
        else:
            _run_batches(campaign, alone, writer, found, until)
        confirm(campaign, alone, writer, found.done)
        _run_ladders(campaign.whole, ladders, writer, found.done)
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
    """Run these in batches, and record the progress."""
    request = campaign.request
    runs = in_order(mutants, request.rounds, found.done, request.seed, found.before)
    seconds = request.budget or 0.0
    left = max(until - request.clock(), 0.0)
    campaign.progress.note(f"budget: {duration_text(seconds)}, of which {left:.0f} s are left")
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


def _run_ladders(
    campaign: Campaign, ladders: Ladders, writer: OutcomeWriter, done: Collection[RunId]
) -> None:
    """Find the thresholds of these ladders. ``done``: runs whose outcomes the journal holds already."""
    if not ladders:
        return
    request = campaign.request
    kept = {
        (outcome.mutant, outcome.round): outcome
        for outcome in writer.journal.outcomes()
        if (outcome.mutant, outcome.round) in done
    }

    def run(runs: Sequence[MutantRun]) -> list[Outcome]:
        found = [kept[mutant.id, round] for mutant, round in runs if (mutant.id, round) in kept]
        new = [(mutant, round) for mutant, round in runs if (mutant.id, round) not in kept]
        run_trials(campaign, new, writer, found.append)
        return found

    always = demanded_of(ladders, request.configuration.demands, request.vocabulary)
    whole_ladders = {name: those for name, those in ladders.items() if _is_whole(those)}
    always |= {
        name: tuple(mutant.magnitude or 0.0 for mutant in those) for name, those in whole_ladders.items()
    }
    count = search_ladders(ladders, run, rounds=request.rounds, seed=request.seed, always=always)
    whole = request.rounds * sum(map(len, ladders.values()))
    campaign.progress.note(
        f"thresholds: {plural(len(ladders), 'ladder')} in {plural(request.rounds, 'round')} took "
        f"{plural(count, 'run')}; all their magnitudes would have taken {whole}"
    )


def _is_whole(ladder: Sequence[Mutant]) -> bool:
    """Return whether all magnitudes of a ladder are run, as tests may notice one and miss a larger one."""
    return not provider(ladder[0].provider).is_monotone(ladder[0].operator)


def in_order(
    mutants: Sequence[Mutant],
    rounds: int,
    done: Iterable[RunId],
    seed: int,
    before: Mapping[RunId, Verdict],
) -> list[MutantRun]:
    """Return all runs that are not done, the most informative first, one round after the other.

    Among those that are expected to be as informative, the order depends on the seed and the mutants' ids
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
        for run in sorted(
            ((mutant, round) for mutant in shuffled(mutants, f"{seed}:budget:{round}")), key=rank
        )
        if (run[0].id, round) not in done
    ]
