"""The whole suite in a fresh process per mutant and round: ``replay``, and every second look."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from mutabot.campaign.baseline.baseline import Baseline, observation, places_of
from mutabot.campaign.baseline.site_names import Sources
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.verdict import Death, Run, judged, not_judged
from mutabot.execution.task import Result, Task, death
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.events import TestEnd
from mutabot.model.job import Job

#: a mutant in a round
MutantRun = tuple[Mutant, int]
#: how many times its baseline's wall clock a test may take before the safety net ends it
WALL_FACTOR = 10.0


def replay(campaign: Campaign, runs: Iterable[MutantRun]) -> Iterator[Outcome]:
    """Run mutants in rounds. Yields outcomes as they come.

    What a limit of wall clock ended on a busy machine is run once more alone, see ``run_alone``.
    """
    hindered: list[tuple[Mutant, Outcome]] = []
    for mutant, outcome in _run(campaign, runs):
        if outcome.beside is None:
            yield outcome
        else:
            hindered.append((mutant, outcome))
    yield from run_alone(campaign, hindered)


def run_alone(campaign: Campaign, hindered: Sequence[tuple[Mutant, Outcome]]) -> Iterator[Outcome]:
    """Run what was hindered once more with nothing of ours beside it. That counts, however it ends."""
    if not hindered:
        return
    first = {(one.mutant, one.round): one for _, one in hindered}
    changed = 0
    for _, outcome in _run(campaign, [(mutant, one.round) for mutant, one in hindered], alone=True):
        before = first[outcome.mutant, outcome.round]
        changed += outcome.verdict is not before.verdict
        yield replace(outcome, beside=before.beside)
    count = len(hindered)
    campaign.progress.note(
        f"{count} {'run' if count == 1 else 'runs'} that ended by the wall clock while the machine was busy "
        f"{'was' if count == 1 else 'were'} run once more alone; {changed} of {count} ended otherwise"
    )


def _run(
    campaign: Campaign, runs: Iterable[MutantRun], *, alone: bool = False
) -> Iterator[tuple[Mutant, Outcome]]:
    uncovered: list[MutantRun] = []

    def tasks() -> Iterator[Task]:
        for mutant, round in runs:
            if campaign.baseline.tests_reaching(round, mutant):
                made = task(campaign, mutant, round, campaign.baseline.suite(round))
                yield replace(made, alone=alone or made.alone)
            else:
                uncovered.append((mutant, round))

    for result in campaign.executor.run(tasks()):
        mutant, round = result.task.key
        try:
            yield mutant, judged(campaign, run_of(result, campaign.sources))
        except Exception as error:
            yield mutant, not_judged(mutant, round, error, "replay")
    for mutant, round in uncovered:
        yield mutant, without_tests(campaign.baseline, mutant, round)


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
        moments=baseline.strides.get(round, {}),
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


def without_tests(baseline: Baseline, mutant: Mutant, round: int) -> Outcome:
    """The outcome of a mutant that no test can judge in this round."""
    aside = baseline.missing_judges(round, mutant)
    if aside:
        text = f"all tests that reach the site are set aside in this round, such as {aside[0]}"
        return Outcome(mutant.id, round, Verdict.UNSTABLE, message=text)
    text = "no test reaches the site in this round"
    return Outcome(mutant.id, round, Verdict.NOT_COVERED, message=text, executed={})


def run_of(result: Result, sources: Sources) -> Run:
    """What a worker saw of its mutant."""
    job = result.task.job
    assert job.mutant is not None
    places = places_of(result, sources)
    left_out = job.left_out(job.mutant.id)
    not_there = (f"{file}: {why}" for file, why in result.not_instrumented.items())
    return Run(
        mutant=job.mutant,
        round=job.round,
        tests=job.tests or (),
        left_out=left_out,
        ends=result.ends,
        observations={end.test: observation(end, places) for end in result.ends if end.outcome != "failed"},
        death=_death(result, {*(job.tests or ())} - left_out),
        exit_code=result.exit_code if result.end is not None else None,
        problem=result.untrusted if result.untrusted is not None else next(not_there, None),
        wall=result.wall,
    )


def _death(result: Result, tests: Collection[str]) -> Death | None:
    """Set if the process did not run all its tests to their end; None if it did, or stopped at a verdict."""
    if result.end is None:
        text: str | None = death(result)
    elif result.end.errors:
        text = "; ".join(result.end.errors)
    else:
        text = not_run(tests, result.ends, result.exit_code)
    if text is None:
        return None
    return Death(
        text=text,
        test=result.running,
        signal=-result.exit_code if result.end is None and result.exit_code < 0 else None,
        overdue=result.overdue is not None and (result.running is not None or "" in result.acted),
        acted=not {result.running, ""}.isdisjoint(result.acted),
        in_mutated_call=result.in_mutated_call,
        hindered=result.hindered,
        is_starved=result.is_starved,
    )


def not_run(tests: Collection[str], ends: Collection[TestEnd], exit_code: int) -> str | None:
    """Why nothing is known of tests although the session has come to its end; None if that says enough.

    A suite that ends early, and says so by its exit code, has ended otherwise than on the original.
    """
    missing = set(tests) - {end.test for end in ends}
    if not missing or any(end.is_decided for end in ends) or exit_code not in (0, 1):
        return None
    return f"{len(missing)} tests did not run, such as {min(missing)}"
