"""Search thresholds on ladders with as few runs as it takes.

The first round of a ladder is
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
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from random import Random
from typing import TYPE_CHECKING

from mutabot.campaign.engines.engine import run_trials
from mutabot.errors import plural
from mutabot.model.graded import MagnitudeResult, bracket_of, seen

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign
    from mutabot.campaign.faults.demanded import Ladders
    from mutabot.campaign.reuse.keys import OutcomeWriter
    from mutabot.model import Outcome

#: indices of a ladder's magnitudes, from the smallest
LadderStep = int


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
    always: frozenset[LadderStep] = frozenset()
    found: dict[int, dict[LadderStep, MagnitudeResult]] = field(default_factory=dict)
    _guards: set[int] = field(default_factory=set)

    def take(self, round: int, step: LadderStep, seen: MagnitudeResult) -> None:
        """A magnitude was run in a round."""
        self.found.setdefault(round, {})[step] = seen

    @property
    def is_violated(self) -> bool:
        """Whether any round missed a larger fault where it noticed a smaller one."""
        rows = ({float(step): one for step, one in row.items()} for row in self.found.values())
        return any(bracket_of(row).is_violated for row in rows)

    def due(self, round: int) -> set[LadderStep]:
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

    def _guess(self, round: int) -> tuple[LadderStep, ...]:
        """Both ends of the bracket of the first round; none in that round itself, or if it knows nothing."""
        row = self.found.get(0, {})
        if round == 0 or not any(one.is_valid for one in row.values()):
            return ()
        return _ends(row, self.size)

    def _guard(
        self, round: int, row: Mapping[LadderStep, MagnitudeResult], left: set[LadderStep]
    ) -> set[LadderStep]:
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


def _ends(row: Mapping[LadderStep, MagnitudeResult], size: int) -> tuple[LadderStep, LadderStep]:
    """The largest step that was missed, and the smallest above it that was noticed or refused.

    −1 and ``size`` where there is none.
    """
    low = max((step for step, one in row.items() if one is MagnitudeResult.MISSED), default=-1)
    bounds = (MagnitudeResult.NOTICED, MagnitudeResult.REFUSED)
    high = min((step for step, one in row.items() if one in bounds and step > low), default=size)
    return low, high


def _middle(row: Mapping[LadderStep, MagnitudeResult], low: LadderStep, high: LadderStep) -> set[LadderStep]:
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
        f"thresholds: {plural(len(ladders), 'ladder')} in {plural(len(rounds), 'round')} took "
        f"{plural(runs, 'run')}; all their magnitudes "
        f"would have taken {whole}"
    )
