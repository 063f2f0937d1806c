"""Batches: as much at a time as is expected to end in half of the time that is left.

A batch shares its trunks, so few large ones are better than many; that the time is up in the midst of one is
unlikely to cost much, since batches get smaller towards the end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.engine import Trial

#: the share of the time left that a batch may take, and that of the first, whose cost is a guess
_SHARE, _FIRST = 0.5, 0.2
#: a batch is to cost so many times what its trunks do, if that takes no more than this share of the time left
_WORTH, _MOST = 4.0, 0.8
#: a mutant ends in the midst of its tests, mostly: the share of their time that is expected of the first
_GUESS = 0.6


@dataclass(slots=True)
class Batches:
    """Batches of trials, sized by what those before have cost.

    Attributes:
        campaign: the campaign.
        until: when all must have ended, by ``Request.clock``.
    """

    campaign: Campaign
    until: float
    _factor: float = field(init=False)
    _is_measured: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        self._factor = _GUESS / self.campaign.request.jobs

    @property
    def left(self) -> float:
        """Seconds that are left."""
        return self.until - self.campaign.request.clock()

    def size(self, trials: Sequence[Trial]) -> int:
        """How many of these, from the first on, to run at once; 0 if not even one would end in time."""
        left = self.left
        wanted = left * (_SHARE if self._is_measured else _FIRST)
        tests: set[tuple[int, str]] = set()
        count, cost = 0, 0.0
        for mutant, round in trials:
            judges = self.campaign.baseline.judges(round, mutant)
            tests.update((round, test) for test in judges)
            cost += sum(self._wall(round, test) for test in judges) * self._factor
            trunks = self._trunks(tests)
            if cost + trunks > max(wanted, min(_WORTH * trunks, _MOST * left)) and count:
                return count
            if cost + trunks > left:
                return 0
            count += 1
        return count

    def took(self, trials: Sequence[Trial], seconds: float) -> None:
        """Learn from a batch what they really cost."""
        tests = {
            (round, test) for mutant, round in trials for test in self.campaign.baseline.judges(round, mutant)
        }
        whole = sum(
            self._wall(round, test)
            for mutant, round in trials
            for test in self.campaign.baseline.judges(round, mutant)
        )
        if whole > 0:
            self._factor = max(seconds - self._trunks(tests), 0.1 * seconds) / whole
            self._is_measured = True

    def _wall(self, round: int, test: str) -> float:
        return max(self.campaign.baseline.ends[round, test].wall, 1e-3)

    def _trunks(self, tests: set[tuple[int, str]]) -> float:
        """What it takes to run each of these tests once more as the original, and to begin."""
        wall = sum(self._wall(round, test) for round, test in tests)
        return wall / self.campaign.request.jobs + (self.campaign.baseline.startup if tests else 0.0)


def run_in_batches(
    batches: Batches,
    trials: Sequence[Trial],
    run: Callable[[Sequence[Trial]], None],
    ended: Callable[[int], None],
) -> bool:
    """Run trials in this order; returns whether all were run.

    Args:
        run: runs some of them, all at once.
        ended: told after each batch how many have been run until then.
    """
    done = 0
    while done < len(trials):
        size = batches.size(trials[done:])
        if size == 0:
            return False
        batch = trials[done : done + size]
        began = batches.left
        run(batch)
        batches.took(batch, began - batches.left)
        done += size
        ended(done)
    return True
