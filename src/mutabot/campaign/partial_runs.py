"""Run parts of a campaign again, beside its journal: its original, and some of its mutants."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Self

from mutabot.campaign import preparation
from mutabot.campaign.baseline.suite_runs import take_baseline
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.controls import run_controls
from mutabot.campaign.engines.replay import replay
from mutabot.campaign.faults.providers import texts_of
from mutabot.campaign.plan import make_plan
from mutabot.campaign.run import run_campaign
from mutabot.errors import SelectionError
from mutabot.execution.task import Result, Task
from mutabot.faults import PlannedMutant
from mutabot.journal.records import Replayed
from mutabot.model.activation import Activation
from mutabot.model.deadline import Limit
from mutabot.model.mutant import Mutant, Place
from mutabot.model.outcome_text import outcome_text

if TYPE_CHECKING:
    from pathlib import Path

    from mutabot.campaign.request import Progress, Request
    from mutabot.journal.reader import JournalReader

#: seconds that the original gets until its first test begins, where nothing is known of it
_STARTUP = 300.0


@dataclass(frozen=True)
class CampaignRun(Campaign):
    """A campaign that is run in parts: its baseline, and then whatever its user asks for.

    ``task`` makes tasks of its mutants, and ``executor`` runs them.

    Attributes, beside those of ``Campaign``:
        originals: what became of the suite on the original, once per round; ``task.key`` is the round (from
            0) and a 0.
        planned: the mutants of the program as it is now, by their ids.
    """

    originals: tuple[Result, ...] = ()
    planned: Mapping[str, Mutant] = field(default_factory=dict)

    @classmethod
    @contextmanager
    def open(cls, request: Request, progress: Progress) -> Iterator[Self]:
        """Take the baseline, each round once, and yield the campaign. Leaving the context ends all processes.

        Raises ConfigurationError for a vocabulary that does not fit the program, NothingToDoError without
        tests, BaselineError when tests fail.
        """
        with preparation.open_executor(request, progress) as opened:
            texts = texts_of(request.project, progress.note)
            baseline, results = take_baseline(request, opened, progress, texts=texts, repetitions=1)
            planned = {mutant.id: mutant for mutant in make_plan(baseline, request.project).mutants}
            yield cls(request, baseline, opened, progress, originals=tuple(results), planned=planned)

    @staticmethod
    def to_end(request: Request, progress: Progress) -> Path:
        """Run a whole campaign and return the path of its journal. Raises what ``run_campaign`` raises."""
        return run_campaign(request, progress)

    @staticmethod
    @contextmanager
    def of_original(
        request: Request, rounds: Iterable[int], progress: Progress
    ) -> Iterator[Iterator[Result]]:
        """Yield one iterator of results for each run of the suite on the original in these rounds (from 0).

        Gives the results as they come; ``task.key`` is the round. Leaving the context ends all processes.
        """
        with preparation.open_executor(request, progress) as opened:
            startup, may_share = Limit(_STARTUP), request.forks
            yield opened.run(
                Task(round, request.job(round), startup=startup, may_share=may_share) for round in rounds
            )

    def current(self, mutant: Mutant) -> Mutant:
        """Return a mutant as it is in the program now: edits elsewhere move it.

        Raises SelectionError if the program no longer has it.
        """
        place = Place.of(mutant)
        if place in self.baseline.hits:  # which it also is if its family or magnitude is not chosen now
            self.baseline.plant(PlannedMutant(mutant, active=Activation.of_call(place)))
            return mutant
        if mutant.id not in self.planned:
            why = "the program has changed, or the configuration does not name its file any more"
            raise SelectionError(f"no test reaches {mutant.id} now: {why}")
        return replace(self.planned[mutant.id], number=mutant.number)

    def prove(self, mutants: Iterable[Mutant]) -> None:
        """Run controls for the way these mutants are run in. Raises ControlError if one ends wrongly."""
        for _ in run_controls(self, list(mutants)):
            pass


def replay_one(
    request: Request, journal: JournalReader, mutant: Mutant, rounds: Iterable[int], progress: Progress
) -> list[Replayed]:
    """Replay one mutant in these rounds, without changing the journal.

    Raises what ``CampaignRun.open`` and ``CampaignRun.current`` raise.
    """
    rounds = sorted(set(rounds))
    first = {(outcome.mutant, outcome.round): outcome for outcome in journal.outcomes()}
    with CampaignRun.open(replace(request, rounds=rounds[-1] + 1), progress) as campaign:
        now = campaign.current(mutant)
        campaign.prove([now])
        progress.stage("replay", len(rounds))
        second = {}
        for outcome in replay(campaign, [(now, round) for round in rounds]):
            second[outcome.round] = outcome
            progress.advance(outcome_text(outcome))
    return [Replayed(round, first.get((now.id, round)), second[round]) for round in rounds]
