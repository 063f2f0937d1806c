"""A campaign under way: what is asked, what is known of the original, who runs tasks, and who is told.

It is made once the baseline is taken, and all that give mutants their outcomes work on it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property

from mutabot.campaign.baseline.baseline import Baseline, Sources
from mutabot.campaign.evidence import CampaignEvidence
from mutabot.campaign.request import Progress, Request
from mutabot.execution.task import Executor
from mutabot.execution.workers import Workers
from mutabot.families import CONTROL
from mutabot.model import Mutant, Outcome


@dataclass(frozen=True)
class Campaign:
    """One campaign.

    Attributes:
        request: what is asked.
        baseline: what is known of the original. It grows by what later runs of the original tell, and by
            its own methods alone.
        executor: runs tasks.
        progress: is told what is going on.
        evidence: what is recorded; None if nothing is.
        proven: ways of running that controls have proven: an engine and ``Control.way``.
        is_short: whether mutants are run without tests that do not reach them, see ``engines.confirmation``.
        again: outcomes that were found so, and are to be found with the whole suite before they count.
    """

    request: Request
    baseline: Baseline
    executor: Executor
    progress: Progress
    evidence: CampaignEvidence | None = None
    proven: set[tuple[str, str, str, bool]] = field(default_factory=set)
    is_short: bool = False
    again: list[Outcome] = field(default_factory=list)

    @cached_property
    def sources(self) -> Sources:
        """Names the sites that workers report."""
        return Sources(self.request.root)

    @property
    def whole(self) -> Campaign:
        """The same, in which every mutant is run with the whole suite."""
        return replace(self, is_short=False)

    def reaching(self, mutants: Iterable[Mutant], round: int) -> dict[str, tuple[int, ...]]:
        """Which tests of the suite are run as which mutant, see ``Job.reaching``."""
        numbers = {test: number for number, test in enumerate(self.baseline.suite(round))}
        return {
            mutant.id: tuple(sorted(numbers[test] for test in self.baseline.tests_reaching(round, mutant)))
            for mutant in (mutants if self.is_short else ())
            if mutant.family != CONTROL
        }


def on_this_machine(request: Request, tell: Callable[[str], None]) -> Workers:
    """As many processes as the request has ``jobs``. Raises JournalError where it cannot write."""
    return Workers(request.root, request.arguments, request.jobs, tell)
