"""A campaign under way: the request, the baseline, the executor and the progress display.

It is made once the baseline is taken, and all that give mutants their outcomes work on it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from mutabot.campaign.baseline.baseline import Baseline, Sources
from mutabot.campaign.evidence import CampaignEvidence
from mutabot.campaign.request import Progress, Request
from mutabot.execution.task import Executor, Task
from mutabot.families import CONTROL
from mutabot.model import Mutant, Outcome
from mutabot.model.deadline import Limit

if TYPE_CHECKING:
    from mutabot.model.job import Job
    from mutabot.model.suppression import Suppression

#: a mutant in a round
MutantRun = tuple[Mutant, int]
#: the same by the mutant's id
RunId = tuple[str, int]
#: seconds by the clock on the wall that any test gets at least: the mutant may wait for what comes at last
WAITING = 60.0
#: seconds of processor time that any test gets beside a multiple of the baseline's; and for mutabot's
#: own work on the calls of a program that polls
SPARE, SPARE_FOR_CALLS = 2.0, 8.0
#: seconds of simulated time likewise
SPARE_SIMULATED = 10.0


@dataclass(frozen=True)
class Campaign:
    """One campaign.

    Attributes:
        request: what is asked.
        baseline: what is known of the original. It grows by what later runs of the original show, and by
            its own methods alone.
        executor: runs tasks.
        progress: shows what is going on.
        evidence: what is recorded; None if nothing is.
        proven: ways of running that controls have proven: an engine and ``Control.way``.
        is_short: whether mutants are run without tests that do not reach them, see ``campaign.confirmation``.
        suppressions: which mutants the user accepts or excludes.
        real: the same over the real middleware, if this one is over a simulation of it.
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
    suppressions: tuple[Suppression, ...] = ()
    real: Campaign | None = None

    @cached_property
    def sources(self) -> Sources:
        """The source files in which the sites that workers report lie."""
        return Sources(self.request.root)

    @property
    def whole(self) -> Campaign:
        """A copy of the campaign that runs every mutant with the whole suite."""
        return replace(self, is_short=False)

    def reaching(self, mutants: Iterable[Mutant], round: int) -> dict[str, tuple[int, ...]]:
        """Return the tests of the suite that are run as each mutant, by its id; see ``Job.reaching``."""
        numbers = {test: number for number, test in enumerate(self.baseline.suite(round))}
        return {
            mutant.id: tuple(sorted(numbers[test] for test in self.baseline.tests_reaching(round, mutant)))
            for mutant in mutants
            if mutant.family != CONTROL and (self.is_short or self.baseline.is_of_tests(mutant))
        }

    def task(self, mutant: Mutant, round: int, tests: tuple[str, ...], *, stop: bool = True) -> Task:
        """Return the task of running these tests as this mutant in a process of its own."""
        request, faults = self.request, self.baseline.faults
        job = self.job(
            round, tests, [mutant],
            mutant=mutant,
            stop_at_kill=stop and not request.every_test,
            instrumentation=faults.instrumentation([mutant]),
            active={mutant.id: faults.active(mutant)},
        )  # fmt: skip
        limits, alone = self.limits(round, tests), self.baseline.is_exclusive(round)
        return Task((mutant, round), job, limits, self.startup_limit, self.startup_limit, alone=alone)

    def job(self, round: int, tests: tuple[str, ...], mutants: Iterable[Mutant], **details: Any) -> Job:
        """Return the job of running these tests as these mutants, with limits based on the baseline."""
        refused = ((test, self.baseline.refused.get((round, test))) for test in tests)
        return self.request.job(
            round,
            tests=tests,
            aside=self.baseline.aside(round, tests),
            record=True,
            reaching=self.reaching(mutants, round),
            simulated=self._simulated(round, tests),
            spare=self._spare,
            moments=self.baseline.probe_intervals.get(round, {}),
            refused={test: calls for test, calls in refused if calls},
            known=self.baseline.known,
            **details,
        )

    @property
    def startup_limit(self) -> Limit:
        """The time limit of a mutant until its first test begins."""
        startup = self.baseline.startup
        return self._limit(startup, startup)

    def limits(self, round: int, tests: Iterable[str]) -> dict[str, Limit]:
        """Return the time limit of a mutant for each of these tests, some of which it may run alone.

        A test that comes after others which are not run may be the first to prepare what these did.
        """
        run, found = set() if self.is_short else set(tests), dict[str, Limit]()
        wall = processor = 0.0
        for test in self.baseline.suite(round):
            end = self.baseline.ends[round, test]
            found[test] = self._limit(end.wall, end.cpu).with_more(wall, processor)
            if test not in run:
                wall, processor = wall + end.wall, processor + end.cpu
        return found

    def _limit(self, wall: float, processor: float) -> Limit:
        """Return the time limit for a run that took this long on the original."""
        factor, least = self._factor, self.request.configuration.timeout_seconds
        if least is None:
            return Limit(max(WAITING, factor * wall), self._spare + factor * processor)
        return Limit(max(least, factor * wall), max(least, factor * processor))

    def _simulated(self, round: int, tests: Iterable[str]) -> dict[str, float]:
        """Return the limit of simulated time (s) for each test that takes any on the original."""
        times = {test: self.baseline.ends[round, test].simulated for test in tests}
        return {
            test: SPARE_SIMULATED + self._factor * time for test, time in times.items() if time is not None
        }

    @property
    def _factor(self) -> float:
        return self.request.configuration.timeout_factor

    @property
    def _spare(self) -> float:
        """The processor time (s) that any test gets beside a multiple of the baseline's."""
        least = self.request.configuration.timeout_seconds
        if least is not None:
            return least
        return SPARE + (SPARE_FOR_CALLS if self.request.vocabulary.operations else 0.0)
