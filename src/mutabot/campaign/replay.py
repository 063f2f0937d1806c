"""The replay engine: one fresh process per (mutant, round). Simple; it defines what is right."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from mutabot.model import Mutant, Outcome, TestEnd, Verdict

from .baseline import Baseline, Place, death, observation, places_of
from .comparison import compare, farthest
from .request import Request
from .sites import Sources
from .workers import Result, Task, Workers

#: how many times its baseline's wall clock a test may take before the safety net ends it
WALL_FACTOR = 10.0


def replay(
    request: Request, baseline: Baseline, workers: Workers, mutants: Iterable[Mutant]
) -> Iterator[Outcome]:
    """Outcomes of all mutants in all rounds, as they come."""
    sources = Sources(request.root)
    uncovered: list[Outcome] = []
    for result in workers.run(_tasks(request, baseline, mutants, uncovered)):
        yield from _drain(uncovered)
        yield judge(result, request, baseline, sources)
    yield from _drain(uncovered)


def _drain(outcomes: list[Outcome]) -> Iterator[Outcome]:
    while outcomes:
        yield outcomes.pop(0)


def _tasks(
    request: Request, baseline: Baseline, mutants: Iterable[Mutant], uncovered: list[Outcome]
) -> Iterator[Task]:
    for mutant in mutants:
        place = Place(mutant.site, mutant.operation, mutant.pattern)
        for round in range(request.rounds):
            tests = baseline.selection(round, place)
            if tests:
                yield task(request, baseline, mutant, round, tests)
            else:
                uncovered.append(_not_covered(mutant, round))


def task(
    request: Request,
    baseline: Baseline,
    mutant: Mutant,
    round: int,
    tests: tuple[str, ...],
    *,
    stop: bool = True,
) -> Task:
    """The task of running these tests as this mutant."""
    configuration = request.configuration
    budgets = {test: baseline.budget(round, test, configuration.timeout_factor) for test in tests}
    least = configuration.timeout_seconds
    walls = {test: max(least, WALL_FACTOR * baseline.ends[round, test].wall) for test in tests}
    job = request.job(round, tests=tests, mutant=mutant, record=True, stop_at_kill=stop, budgets=budgets)
    return Task((mutant, round), job, walls, least, max(least, WALL_FACTOR * baseline.startup))


def _not_covered(mutant: Mutant, round: int) -> Outcome:
    text = "no test reaches the site in this round"
    return Outcome(mutant.id, round, Verdict.NOT_COVERED, message=text)


def judge(result: Result, request: Request, baseline: Baseline, sources: Sources) -> Outcome:
    """The one named end of a mutant in a round, from what its process reported."""
    mutant, round = result.task.job.mutant, result.task.job.round
    assert mutant is not None
    verdict, end, message = _verdict(result)
    simulated = [end.simulated for end in result.ends if end.simulated is not None]
    outcome = Outcome(
        mutant=mutant.id,
        round=round,
        verdict=verdict,
        by=end.by if end is not None and verdict is Verdict.KILLED else None,
        test=end.test if end is not None else result.running,
        exception=end.exception if end is not None else None,
        message=message,
        place=end.place if end is not None else None,
        hits=sum(end.hits for end in result.ends),
        acted=sum(end.acted for end in result.ends),
        example=next((end.example for end in result.ends if end.example is not None), None),
        tests=len(result.ends),
        wall=result.wall,
        cpu=sum(end.cpu for end in result.ends),
        simulated=sum(simulated) if simulated else None,
    )
    return _compared(outcome, result, request, baseline, sources) if verdict is Verdict.SURVIVED else outcome


def _verdict(result: Result) -> tuple[Verdict, TestEnd | None, str | None]:
    """Verdict, the test that decided it, and the reason in words."""
    acted = False
    refused: TestEnd | None = None
    for end in result.ends:
        acted = acted or end.acted > 0
        if end.failure is not None:
            return Verdict.ERROR, end, end.failure
        if end.invalid:
            return Verdict.INVALID, end, end.message
        if end.refused is not None and not end.caught:
            refused = refused or end
        elif end.timeout is not None:
            return (Verdict.TIMEOUT if acted else Verdict.UNSTABLE), end, end.timeout
        elif end.outcome == "failed":
            if acted:
                return Verdict.KILLED, end, end.message
            return Verdict.UNSTABLE, end, f"failed before the mutant changed anything: {end.message}"
    unfinished = _unfinished(result, acted)
    if unfinished is not None:
        return unfinished
    if refused is not None:
        return Verdict.REFUSED, refused, refused.refused
    return (*_end_of_survivor(result, acted),)


def _unfinished(result: Result, acted: bool) -> tuple[Verdict, TestEnd | None, str | None] | None:
    """The verdict of a process that did not run all its tests to their end; None if it did."""
    if (
        result.overdue is not None
        and result.running is not None
        and (acted or result.running in result.acted)
    ):
        return Verdict.TIMEOUT, None, result.overdue
    if result.end is None:
        return Verdict.ERROR, None, death(result)
    if result.end.errors:
        return Verdict.ERROR, None, "; ".join(result.end.errors)
    missing = set(result.task.job.tests or ()) - {end.test for end in result.ends}
    if missing:
        return Verdict.ERROR, None, f"{len(missing)} tests did not run, such as {min(missing)}"
    return None


def _end_of_survivor(result: Result, acted: bool) -> tuple[Verdict, TestEnd | None, str | None]:
    if acted:
        return Verdict.SURVIVED, None, None
    if any(end.hits for end in result.ends):
        return Verdict.NO_EFFECT, None, "the site was reached, but no value changed"
    return Verdict.UNSTABLE, None, "the site was reached in the baseline, but not now"


def _compared(
    outcome: Outcome, result: Result, request: Request, baseline: Baseline, sources: Sources
) -> Outcome:
    """The outcome of a survivor with how far its world is from the original's."""
    places = places_of(result, sources)
    comparisons = []
    for end in result.ends:
        key = (outcome.round, end.test)
        if key in baseline.restless:
            return outcome
        found = observation(end, places)
        comparisons.append(compare(baseline.observations[key], found, request.vocabulary.probes))
    worst = farthest(comparisons)
    # Without a probe, equal traces say only that the program did the same, not that the world ended so.
    equal = worst.indistinguishable if worst.distance is not None or worst.divergence else None
    return replace(outcome, indistinguishable=equal, distance=worst.distance, divergence=worst.divergence)
