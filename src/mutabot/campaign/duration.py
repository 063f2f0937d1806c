"""An estimate, before any mutant runs, of how long a campaign will take, by its baseline."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from mutabot.config.options import duration_text
from mutabot.errors import plural
from mutabot.frozen import frozen

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign
    from mutabot.model import Mutant

#: seconds that it takes to fork a mutant and to judge it
_FORK = 0.05
#: the share of its tests that a fork runs, which begins where it differs from the original
_SHARE = 0.5
#: how often a round runs the whole suite beside its mutants: for the fork parent and for controls
_SUITES = 2


@frozen
class Duration:
    """An estimate of the duration of a campaign.

    Attributes:
        runs: mutants in rounds.
        jobs: how many of them run at a time.
        seconds: how long all of them take, if none is known from an earlier campaign.
    """

    runs: int
    jobs: int
    seconds: float

    @property
    def text(self) -> str:
        """``about 4 min for 130 runs, 2 at a time``."""
        step = 5 if self.seconds < 100 else 30 if self.seconds < 1000 else 300
        about = max(step, step * round(self.seconds / step))
        return f"about {duration_text(about)} for {plural(self.runs, 'run')}, {self.jobs} at a time"


def duration_of(campaign: Campaign, mutants: Sequence[Mutant]) -> Duration:
    """Estimate how long it takes to run these mutants in all rounds.

    A kill ends a run early: it is rather less. A mutant that waits until its time is up takes more.
    """
    request, baseline = campaign.request, campaign.baseline
    alone = [candidate for candidate in mutants if not candidate.has_sizes]
    seconds = 0.0
    for round in range(request.rounds):
        for mutant in alone:
            if request.forks:
                seconds += _FORK + _SHARE * _wall(campaign, round, baseline.tests_reaching(round, mutant))
            else:
                seconds += baseline.startup + _wall(
                    campaign, round, baseline.tests_from_first_reach(round, mutant)
                )
        seconds += _SUITES * (baseline.startup + _wall(campaign, round, baseline.suite(round)))
    is_alone = any(baseline.is_exclusive(round) for round in range(request.rounds))
    jobs = 1 if is_alone else request.jobs
    return Duration(request.rounds * len(alone), jobs, seconds / jobs)


def _wall(campaign: Campaign, round: int, tests: Iterable[str]) -> float:
    """Return the wall-clock time (s) that tests took on the original."""
    return sum(campaign.baseline.ends[round, test].wall for test in tests)
