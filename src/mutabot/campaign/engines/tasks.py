"""Tasks that run the suite as a mutant in a process of its own, and the limits that the baseline gives."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from mutabot.campaign.campaign import Campaign
from mutabot.execution.task import Task
from mutabot.model import Mutant
from mutabot.model.job import Job

#: a mutant in a round
MutantRun = tuple[Mutant, int]
#: how many times its baseline's wall clock a test may take before the safety net ends it
WALL_FACTOR = 10.0


def task(
    campaign: Campaign, mutant: Mutant, round: int, tests: tuple[str, ...], *, stop: bool = True
) -> Task:
    """The task of running these tests as this mutant."""
    request, faults = campaign.request, campaign.baseline.faults
    job = job_of(
        campaign, round, tests, [mutant],
        mutant=mutant,
        stop_at_kill=stop and not request.every_test,
        instrumentation=faults.instrumentation([mutant], active=True),
        faults=faults.in_process(mutant),
    )  # fmt: skip
    walls = wall_limits(campaign, round, tests)
    least, startup = request.configuration.timeout_seconds, startup_limit(campaign)
    return Task((mutant, round), job, walls, least, startup, alone=campaign.baseline.is_exclusive(round))


def job_of(
    campaign: Campaign, round: int, tests: tuple[str, ...], mutants: Iterable[Mutant], **details: Any
) -> Job:
    """The job of running these tests as these mutants, with the limits that the baseline gives."""
    request, baseline = campaign.request, campaign.baseline
    factor = request.configuration.timeout_factor
    return request.job(
        round,
        tests=tests,
        record=True,
        reaching=campaign.reaching(mutants, round),
        budgets={test: baseline.budget(round, test, factor) for test in tests},
        moments=baseline.probe_intervals.get(round, {}),
        refused=baseline.refused_in(round, tests),
        known=baseline.known,
        **details,
    )


def startup_limit(campaign: Campaign) -> float:
    """Seconds of wall clock that a mutant may take until its first test begins."""
    least = campaign.request.configuration.timeout_seconds
    return max(least, WALL_FACTOR * campaign.baseline.startup)


def wall_limits(campaign: Campaign, round: int, tests: Iterable[str]) -> dict[str, float]:
    """Seconds of wall clock that each test may take: the safety net behind the other limits."""
    least, ends = campaign.request.configuration.timeout_seconds, campaign.baseline.ends
    return {test: max(least, WALL_FACTOR * ends[round, test].wall) for test in tests}
