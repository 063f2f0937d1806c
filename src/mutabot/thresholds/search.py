"""Search the thresholds of ladders with as few runs as possible.

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
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from random import Random
from typing import TYPE_CHECKING

from mutabot.thresholds.brackets import MagnitudeResult, bracket_of, seen

if TYPE_CHECKING:
    from mutabot.model import Mutant, Outcome
    from mutabot.thresholds.planned import Ladders

#: indices of a ladder's magnitudes, from the smallest
LadderStep = int
#: a mutant, and the round in which it is run
Trial = tuple["Mutant", int]


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
        """Note the result of a magnitude in a round."""
        self.found.setdefault(round, {})[step] = seen

    @property
    def is_violated(self) -> bool:
        """Whether any round missed a larger fault and noticed a smaller one."""
        rows = ({float(step): result for step, result in row.items()} for row in self.found.values())
        return any(bracket_of(row).is_violated for row in rows)

    def due(self, round: int) -> set[LadderStep]:
        """Return the magnitudes to run next in a round; empty if the round is done."""
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
        """Return the first round's bracket as a guess; empty in that round itself, or without a bracket."""
        row = self.found.get(0, {})
        if round == 0 or not any(result.is_valid for result in row.values()):
            return ()
        return _ends(row, self.size)

    def _guard(
        self, round: int, row: Mapping[LadderStep, MagnitudeResult], left: set[LadderStep]
    ) -> set[LadderStep]:
        """Return one more magnitude to check, the first time that no other is left."""
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
    """Return the largest step that was missed, and the next step that was noticed or refused.

    −1 and ``size`` where there is none.
    """
    low = max((step for step, result in row.items() if result is MagnitudeResult.MISSED), default=-1)
    bounds = (MagnitudeResult.NOTICED, MagnitudeResult.REFUSED)
    high = min((step for step, result in row.items() if result in bounds and step > low), default=size)
    return low, high


def _middle(row: Mapping[LadderStep, MagnitudeResult], low: LadderStep, high: LadderStep) -> set[LadderStep]:
    """Return the middle step of those between two that were not run; empty if all were."""
    between = [step for step in range(low + 1, high) if step not in row]
    return {between[len(between) // 2]} if between else set()


def search_ladders(
    ladders: Ladders,
    run: Callable[[Sequence[Trial]], Iterable[Outcome]],
    *,
    rounds: int,
    seed: int,
    always: Mapping[str, Collection[float]],
) -> int:
    """Find the thresholds of all ladders. Return how many runs that took, including known ones.

    Args:
        ladders: their mutants, rising.
        run: gives the outcomes of mutants in rounds; one that is missing is asked for again.
        rounds: how many there are.
        seed: breaks ties.
        always: magnitudes that are run in every round, by ladder.
    """
    searches = dict[str, LadderSearch]()
    for name, mutants in ladders.items():
        demanded = always.get(name, ())
        steps = frozenset(step for step, tried in enumerate(mutants) if tried.magnitude in demanded)
        searches[name] = LadderSearch(len(mutants), rounds, seed, steps)
    for known in (range(rounds)[:1], range(rounds)):
        # until nothing more is asked in these rounds; a violation asks in all of them
        while trials := [
            (searches[name], step, mutants[step], round)
            for round in known
            for name, mutants in ladders.items()
            for step in sorted(searches[name].due(round))
        ]:
            outcomes = run([(mutant, round) for *_, mutant, round in trials])
            ended = {(outcome.mutant, outcome.round): outcome for outcome in outcomes}
            for search, step, mutant, round in trials:
                outcome = ended.get((mutant.id, round))
                if outcome is not None:
                    search.take(round, step, seen(outcome))
    return sum(len(row) for search in searches.values() for row in search.found.values())
