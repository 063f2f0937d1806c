"""The budget of a campaign: what tells most first, an end in time, and what that says about all mutants."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from mutabot.border.codec import to_data
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.choice import run_trials
from mutabot.campaign.engines.engine import Trial
from mutabot.campaign.plan.ladders import apart
from mutabot.campaign.reuse.reuse import Reused
from mutabot.campaign.search.search import run_ladders
from mutabot.campaign.sink import Sink
from mutabot.campaign.workers.interruption import OutOfTimeError, limited
from mutabot.journal.records import BUDGET, Budgeted, BudgetedClass
from mutabot.model import Mutant
from mutabot.settings.duration import in_words

from .batches import Batches, run_in_batches
from .order import Class, Pair, in_order

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
    classes = in_order(alone, request.rounds, found.done, request.seed, found.before, found.sites)
    seconds = request.budget or 0.0
    written = _Written(sink, classes, Budgeted(seconds, done=_numbers(alone, found.done)))
    progress.note(f"budget: {in_words(seconds)}, of which {max(until - request.clock(), 0.0):.0f} s are left")
    batches = Batches(campaign, until)
    trials = [trial for one in classes for trial in one.trials]

    def run(batch: Sequence[Trial]) -> None:
        run_trials(campaign, batch, sink)

    try:
        with limited(until, request.clock):
            is_whole = run_in_batches(batches, trials, run, written.note)
            if is_whole and ladders:
                run_ladders(campaign, ladders, sink, found.done)
    except OutOfTimeError:
        is_whole = False
    written.end(is_whole)
    if not is_whole:
        progress.note(f"the budget is spent: {written.told}; `mutabot run` goes on with what is left")
    return is_whole


def _numbers(mutants: Sequence[Mutant], done: Collection[Pair]) -> tuple[tuple[int, int], ...]:
    numbers = {mutant.id: mutant.number for mutant in mutants}
    return tuple(sorted((numbers[name], round) for name, round in done if name in numbers))


class _Written:
    """How far it has come, written down after each batch."""

    def __init__(self, sink: Sink, classes: Sequence[Class], budgeted: Budgeted) -> None:
        self._sink, self._classes, self._budgeted = sink, classes, budgeted
        self.note(0)

    @property
    def told(self) -> str:
        """In words."""
        ended = sum(one.counted for one in self._budgeted.classes)
        planned = sum(len(one.trials) for one in self._classes)
        return f"{ended} of {planned} outcomes were found in batches that ended in time"

    def note(self, count: int) -> None:
        """So many, in their order, have ended."""
        found = []
        for one in self._classes:
            counted = min(count, len(one.trials))
            count -= counted
            numbers = tuple(mutant.number for mutant, _ in one.trials)
            found.append(BudgetedClass(one.name, one.round, numbers, counted))
        self._budgeted = replace(self._budgeted, classes=tuple(found))
        self._sink.journal.set_meta(BUDGET, to_data(self._budgeted))

    def end(self, is_whole: bool) -> None:
        """Note whether all was run."""
        self._budgeted = replace(self._budgeted, is_whole=is_whole)
        self._sink.journal.set_meta(BUDGET, to_data(self._budgeted))
