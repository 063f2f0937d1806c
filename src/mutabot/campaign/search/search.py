"""The search on all ladders of a campaign at once: in waves, so that one trunk serves the faults of a round.

The first round comes first; the others, which begin with what it found, run side by side.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.choice import run_trials
from mutabot.campaign.engines.engine import Trial
from mutabot.campaign.faults.ladders import Ladder
from mutabot.campaign.sink import Sink
from mutabot.model import Outcome
from mutabot.model.graded.ladder import seen

from .ladder import LadderSearch, Step, steps_run


def run_ladders(
    campaign: Campaign,
    ladders: Sequence[Ladder],
    sink: Sink,
    done: Collection[tuple[str, int]] = (),
    always: Mapping[str, Collection[float]] | None = None,
) -> None:
    """Find the thresholds; every outcome is in the journal within a second.

    ``done`` are the ids and rounds whose outcomes the journal holds already. ``always`` gives magnitudes that
    are run in every round, by ladder.

    Raises ControlError for a control that ends wrongly.
    """
    if not ladders:
        return
    kept = {
        (one.mutant, one.round): one for one in sink.journal.outcomes() if (one.mutant, one.round) in done
    }
    search = _Search(campaign, ladders, sink, kept, always or {})
    rounds = range(campaign.request.rounds)
    search.run(rounds[:1])
    search.run(rounds[1:])
    whole = len(rounds) * sum(len(ladder.mutants) for ladder in ladders)
    runs = steps_run(search.searches.values())
    campaign.progress.note(
        f"thresholds: {len(ladders)} ladders in {len(rounds)} rounds took {runs} runs; all their magnitudes "
        f"would have taken {whole}"
    )


@dataclass(slots=True)
class _Search:
    campaign: Campaign
    ladders: Sequence[Ladder]
    sink: Sink
    kept: Mapping[tuple[str, int], Outcome]
    always: Mapping[str, Collection[float]]
    searches: dict[str, LadderSearch] = field(init=False)

    def __post_init__(self) -> None:
        request = self.campaign.request
        self.searches = {
            one.id: LadderSearch(
                len(one.mutants), request.rounds, seed=request.seed, always=self._always(one)
            )
            for one in self.ladders
        }

    def run(self, rounds: Sequence[int]) -> None:
        """Run until nothing more is asked in these rounds; a violation asks in all before as well."""
        known = range(max(rounds, default=-1) + 1)
        while trials := [trial for round in known for trial in self._due(round)]:
            new: list[Trial] = []
            for ladder, step, round in trials:
                mutant = ladder.mutants[step]
                outcome = self.kept.get((mutant.id, round))
                if outcome is None:
                    new.append((mutant, round))
                else:
                    self._take(ladder, step, outcome)
            ended: dict[tuple[str, int], Outcome] = {}

            def take(one: Outcome, ended: dict[tuple[str, int], Outcome] = ended) -> None:
                ended[one.mutant, one.round] = one

            run_trials(self.campaign, new, self.sink, take)
            for ladder, step, round in trials:
                outcome = ended.get((ladder.mutants[step].id, round))
                if outcome is not None:
                    self._take(ladder, step, outcome)

    def _due(self, round: int) -> Iterable[tuple[Ladder, Step, int]]:
        for ladder in self.ladders:
            for step in sorted(self.searches[ladder.id].due(round)):
                yield ladder, step, round

    def _take(self, ladder: Ladder, step: Step, outcome: Outcome) -> None:
        self.searches[ladder.id].take(outcome.round, step, seen(outcome))

    def _always(self, ladder: Ladder) -> frozenset[Step]:
        sizes = self.always.get(ladder.id, ())
        return frozenset(step for step, one in enumerate(ladder.mutants) if one.magnitude in sizes)
