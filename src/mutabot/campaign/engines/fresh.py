"""One fresh process per (mutant, round), and what was seen of it: replay, and every second look."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.observed import observation, places_of
from mutabot.campaign.baseline.site_names import Sources
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.comparing.moments import moments_in
from mutabot.campaign.workers.task import Result, Task, death
from mutabot.model import Mutant, Outcome, Verdict

from .engine import Trial
from .judge import Death, Run, judged, not_judged

#: the engine that is the reference
REPLAY = "replay"
#: how many times its baseline's wall clock a test may take before the safety net ends it
WALL_FACTOR = 10.0


def replay(campaign: Campaign, trials: Iterable[Trial], engine: str = REPLAY) -> Iterator[Outcome]:
    """Outcomes of mutants in rounds, as they come; any ``engine`` but replay begins its processes warm."""
    baseline = campaign.baseline
    uncovered: list[Outcome] = []
    widened: list[Trial] = []
    tasks = _tasks(campaign, trials, uncovered)
    for result in campaign.executor.run(replace(one, begins_warm=engine != REPLAY) for one in tasks):
        yield from _drain(uncovered)
        mutant, round = trial_of(result)
        outcome = _outcome(campaign, result, engine)
        if outcome.verdict is Verdict.SURVIVED and baseline.must_widen(mutant, round, result.ends):
            widened.append((mutant, round))
        else:
            yield outcome
    yield from _drain(uncovered)
    if widened:
        yield from replay(campaign, widened, engine)


def trial_of(result: Result) -> Trial:
    """Which mutant was run, and in which round."""
    job = result.task.job
    assert job.mutant is not None
    return job.mutant, job.round


def _outcome(campaign: Campaign, result: Result, engine: str) -> Outcome:
    try:
        run = replace(run_of(result, campaign.sources), engine=engine)
    except Exception as error:
        return not_judged(*trial_of(result), error, engine)
    return judged(campaign, run)


def longest_first(campaign: Campaign, trials: list[Trial]) -> list[Trial]:
    """Trials in an order that leaves no place with the last one; as they are where all share one machine."""
    if campaign.executor.spread < 2:
        return trials
    baseline = campaign.baseline

    def seconds(trial: Trial) -> float:
        mutant, round = trial
        return sum(baseline.ends[round, test].wall for test in baseline.judges(round, mutant))

    return sorted(trials, key=seconds, reverse=True)


def _drain(outcomes: list[Outcome]) -> Iterator[Outcome]:
    while outcomes:
        yield outcomes.pop(0)


def _tasks(campaign: Campaign, trials: Iterable[Trial], uncovered: list[Outcome]) -> Iterator[Task]:
    for mutant, round in trials:
        tests = campaign.baseline.judges(round, mutant)
        if tests:
            yield task(campaign, mutant, round, tests)
        else:
            uncovered.append(without_tests(campaign.baseline, mutant, round))


def task(
    campaign: Campaign, mutant: Mutant, round: int, tests: tuple[str, ...], *, stop: bool = True
) -> Task:
    """The task of running these tests as this mutant."""
    request, baseline = campaign.request, campaign.baseline
    budgets = {test: baseline.budget(round, test, request.configuration.timeout_factor) for test in tests}
    walls = {test: wall_limit(campaign, round, test) for test in tests}
    job = request.job(
        round,
        tests=tests,
        mutant=mutant,
        record=True,
        stop_at_kill=stop and not request.every_test,
        budgets=budgets,
        moments=moments_in(baseline.strides, round),
        instrumentation=baseline.program.instrumentation([mutant], active=True),
    )
    least = request.configuration.timeout_seconds
    startup = max(least, WALL_FACTOR * baseline.startup)
    return Task(
        (mutant, round), job, walls, least, startup, alone=baseline.sharing[round].is_exclusive(tests)
    )


def wall_limit(campaign: Campaign, round: int, test: str) -> float:
    """Seconds of wall clock that a test may take: the safety net behind the other limits."""
    least = campaign.request.configuration.timeout_seconds
    return max(least, WALL_FACTOR * campaign.baseline.ends[round, test].wall)


def without_tests(baseline: Baseline, mutant: Mutant, round: int) -> Outcome:
    """The outcome of a mutant that no test can judge in this round."""
    aside = baseline.missing_judges(round, mutant)
    if aside:
        text = f"all tests that reach the site are set aside in this round, such as {aside[0]}"
        return Outcome(mutant.id, round, Verdict.UNSTABLE, message=text)
    text = "no test reaches the site in this round"
    return Outcome(mutant.id, round, Verdict.NOT_COVERED, message=text)


def run_of(result: Result, sources: Sources) -> Run:
    """What a worker saw of its mutant."""
    mutant, round = trial_of(result)
    places = places_of(result, sources)
    return Run(
        mutant=mutant,
        round=round,
        tests=result.task.job.tests or (),
        ends=result.ends,
        observations={end.test: observation(end, places) for end in result.ends if end.outcome != "failed"},
        death=_death(result),
        problem=_problem(result),
        wall=result.wall,
    )


def _problem(result: Result) -> str | None:
    """Why the mutant was not in the program, if it was not."""
    return next((f"{file}: {why}" for file, why in result.not_instrumented.items()), None)


def _death(result: Result) -> Death | None:
    """Set if the process did not run all its tests to their end; None if it did, or stopped at a verdict."""
    text = None
    if result.end is None:
        text = death(result)
    elif result.end.errors:
        text = "; ".join(result.end.errors)
    else:
        missing = set(result.task.job.tests or ()) - {end.test for end in result.ends}
        if missing:
            text = f"{len(missing)} tests did not run, such as {min(missing)}"
    if text is None:
        return None
    return Death(
        text=text,
        test=result.running,
        signal=-result.exit_code if result.end is None and result.exit_code < 0 else None,
        overdue=result.overdue is not None and (result.running is not None or "" in result.acted),
        acted=not {result.running, ""}.isdisjoint(result.acted),
        in_mutated_call=result.in_mutated_call,
        where=result.where,
    )
