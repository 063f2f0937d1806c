"""The budget of a campaign: what tells most first, and an end in time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from mutabot.border.codec import to_data
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.choice import run_trials
from mutabot.campaign.faults.ladders import apart
from mutabot.campaign.reuse.reuse import Reused
from mutabot.campaign.search.search import run_ladders
from mutabot.campaign.sink import Sink
from mutabot.campaign.workers.interruption import OutOfTimeError, limited
from mutabot.journal.records import BUDGET, Budgeted
from mutabot.model import Mutant, Outcome
from mutabot.settings.duration import in_words

from .batches import Batches, run_in_batches
from .order import in_order

#: how a campaign ended whose budget was not enough
OUT_OF_TIME = "out of time"


def run_within(
    campaign: Campaign, mutants: Sequence[Mutant], sink: Sink, found: Reused, until: float
) -> bool:
    """Run what can be run until then; returns whether that is all.

    What is under way when the time is up is cut off, and nothing is said of it. Ladders come last.

    Args:
        found: what is known before.
        until: when all must have ended, by ``Request.clock``.
    """
    request, progress = campaign.request, campaign.progress
    alone, ladders = apart(mutants)
    trials = in_order(alone, request.rounds, found.done, request.seed, found.before, found.sites)
    seconds = request.budget or 0.0
    budgeted = Budgeted(seconds, planned=len(trials))
    progress.note(f"budget: {in_words(seconds)}, of which {max(until - request.clock(), 0.0):.0f} s are left")
    batches = Batches(campaign, until)
    told = 0

    def take(_: Outcome) -> None:
        nonlocal told
        told += 1

    def note(run: int, is_whole: bool | None = None) -> None:
        nonlocal budgeted
        budgeted = replace(budgeted, run=run, cut_off=told - run, is_whole=is_whole)
        sink.journal.set_meta(BUDGET, to_data(budgeted))

    note(0)
    try:
        with limited(until, request.clock):
            is_whole = run_in_batches(
                batches, trials, lambda batch: run_trials(campaign, batch, sink, take), note
            )
            if is_whole and ladders:
                run_ladders(campaign, ladders, sink, found.done)
    except OutOfTimeError:
        is_whole = False
    note(budgeted.run, is_whole)
    if not is_whole:
        run = f"{budgeted.run + budgeted.cut_off} of {budgeted.planned} outcomes were found"
        progress.note(f"the budget is spent: {run}; `mutabot run` goes on with what is left")
    return is_whole
