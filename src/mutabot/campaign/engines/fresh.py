"""The whole suite in a fresh process per (mutant, round): replay, and every second look."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field, replace

from mutabot.campaign.baseline.baseline import Baseline, observation, places_of
from mutabot.campaign.baseline.site_names import Sources
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.comparison import moments_in
from mutabot.campaign.verdict import Death, Run, judged, not_judged
from mutabot.execution.task import Result, Task, death
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.events import TestEnd
from mutabot.model.outcome import in_words

from .engine import Trial

#: the engine that is the reference
REPLAY = "replay"
#: how many times its baseline's wall clock a test may take before the safety net ends it
WALL_FACTOR = 10.0


@dataclass(slots=True)
class Hindered:
    """Runs that a limit of wall clock ended on a busy machine: nobody can say what that means."""

    trials: list[Trial] = field(default_factory=list)
    ends: dict[tuple[str, int], tuple[Outcome, str]] = field(default_factory=dict)

    def add(self, mutant: Mutant, outcome: Outcome, why: str) -> None:
        """One that ended so, and what the machine did meanwhile."""
        self.trials.append((mutant, outcome.round))
        self.ends[mutant.id, outcome.round] = outcome, why


def replay(campaign: Campaign, trials: Iterable[Trial]) -> Iterator[Outcome]:
    """Outcomes of mutants in rounds, as they come.

    What a limit of wall clock ended on a busy machine is run once more alone, see ``replay_alone``.
    """
    hindered = Hindered()
    yield from _replayed(campaign, trials, hindered)
    yield from replay_alone(campaign, hindered)


def replay_alone(campaign: Campaign, hindered: Hindered) -> Iterator[Outcome]:
    """What was hindered, run once more with nothing of ours beside it: that counts, however it ends."""
    if not hindered.trials:
        return
    changed = 0
    for outcome in _replayed(campaign, hindered.trials, None):
        first, why = hindered.ends[outcome.mutant, outcome.round]
        changed += outcome.verdict is not first.verdict
        yield replace(outcome, beside=f"{in_words(first)}; {why}")
    count = len(hindered.trials)
    campaign.progress.note(
        f"{count} {'run' if count == 1 else 'runs'} that ended by the wall clock while the machine was busy "
        f"{'was' if count == 1 else 'were'} run once more alone; {changed} of {count} ended otherwise"
    )


def _replayed(campaign: Campaign, trials: Iterable[Trial], hindered: Hindered | None) -> Iterator[Outcome]:
    """The same; ``hindered`` takes those that are to be run alone. None: all are run alone."""
    uncovered: list[Outcome] = []
    tasks = _tasks(campaign, trials, uncovered)
    if hindered is None:
        tasks = (replace(one, alone=True) for one in tasks)
    for result in campaign.executor.run(tasks):
        yield from _drain(uncovered)
        outcome, why = _outcome(campaign, result)
        if hindered is not None and why is not None:
            hindered.add(trial_of(result)[0], outcome, why)
        else:
            yield outcome
    yield from _drain(uncovered)


def trial_of(result: Result) -> Trial:
    """Which mutant was run, and in which round."""
    job = result.task.job
    assert job.mutant is not None
    return job.mutant, job.round


def _outcome(campaign: Campaign, result: Result) -> tuple[Outcome, str | None]:
    """The outcome, and why a limit of wall clock that ended the run says little."""
    try:
        run = run_of(result, campaign.sources)
    except Exception as error:
        return not_judged(*trial_of(result), error, REPLAY), None
    return judged(campaign, run), run.hindered


def longest_first(campaign: Campaign, trials: list[Trial]) -> list[Trial]:
    """Trials in an order that leaves no place with the last one; as they are where all share one machine."""
    if campaign.executor.spread < 2:
        return trials
    baseline = campaign.baseline

    def seconds(trial: Trial) -> float:
        _, round = trial
        return sum(baseline.ends[round, test].wall for test in baseline.suite(round))

    return sorted(trials, key=seconds, reverse=True)


def _drain(outcomes: list[Outcome]) -> Iterator[Outcome]:
    while outcomes:
        yield outcomes.pop(0)


def _tasks(campaign: Campaign, trials: Iterable[Trial], uncovered: list[Outcome]) -> Iterator[Task]:
    for mutant, round in trials:
        if campaign.baseline.tests_reaching(round, mutant):
            yield task(campaign, mutant, round, campaign.baseline.suite(round))
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
        reaching=campaign.reaching([mutant], round),
        mutant=mutant,
        record=True,
        stop_at_kill=stop and not request.every_test,
        budgets=budgets,
        moments=moments_in(baseline.strides, round),
        refused=baseline.refused_in(round, tests),
        known=baseline.known,
        instrumentation=baseline.faults.instrumentation([mutant], active=True),
        faults=baseline.faults.in_process(mutant),
    )
    least, startup = request.configuration.timeout_seconds, startup_limit(campaign)
    return Task((mutant, round), job, walls, least, startup, alone=baseline.is_exclusive(round))


def startup_limit(campaign: Campaign) -> float:
    """Seconds of wall clock that a mutant may take until its first test begins."""
    least = campaign.request.configuration.timeout_seconds
    return max(least, WALL_FACTOR * campaign.baseline.startup)


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
        left_out=result.task.job.left_out(mutant.id),
        ends=result.ends,
        observations={end.test: observation(end, places) for end in result.ends if end.outcome != "failed"},
        death=_death(result),
        exit_code=result.exit_code if result.end is not None else None,
        problem=_problem(result),
        wall=result.wall,
    )


def _problem(result: Result) -> str | None:
    """Why nothing is known of the mutant: it was not in the program, or what was told cannot be relied on."""
    if result.untrusted is not None:
        return result.untrusted
    return next((f"{file}: {why}" for file, why in result.not_instrumented.items()), None)


def _death(result: Result) -> Death | None:
    """Set if the process did not run all its tests to their end; None if it did, or stopped at a verdict."""
    text = None
    if result.end is None:
        text = death(result)
    elif result.end.errors:
        text = "; ".join(result.end.errors)
    else:
        job = result.task.job
        left_out = job.left_out(job.mutant.id) if job.mutant is not None else frozenset()
        text = not_run({*(job.tests or ())} - left_out, result.ends, result.exit_code)
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
