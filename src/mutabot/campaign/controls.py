"""Controls: mutants that must survive, and mutants that must die.

The identity mutant goes through all the machinery and changes nothing, so it must survive. It is run with
every selection of tests that a mutant will be judged by, which also finds tests that pass only after
others: their mutants are then judged by the whole suite. The fatal mutant raises, so it must die; it is run
once per test file and proves that turning a mutant on changes anything at all.

A control that ends wrongly stops the campaign: its verdicts could not be believed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from mutabot.errors import ControlError
from mutabot.model import Mutant

from .baseline import Baseline, Place, death
from .journal import ControlEnd
from .replay import task
from .request import Progress, Request
from .workers import Result, Task, Workers


@dataclass(frozen=True, slots=True)
class Control:
    """One control to run.

    Attributes:
        name: ``identity`` or ``fatal``.
        place: where it acts.
        round: the round it is run in.
        tests: the tests to run.
        subject: what it is run for, in words.
    """

    name: str
    place: Place
    round: int
    tests: tuple[str, ...]
    subject: str

    def task(self, request: Request, baseline: Baseline) -> Task:
        """The task that runs it."""
        place = self.place
        mutant = Mutant(
            0, "control", self.name, place.site, place.operation, place.pattern, None, "", self.name
        )
        made = task(request, baseline, mutant, self.round, self.tests, stop=False)
        return Task(self, made.job, made.deadlines, made.deadline, made.startup)


def run_controls(
    request: Request, baseline: Baseline, workers: Workers, progress: Progress, mutants: Iterable[Mutant]
) -> Iterator[ControlEnd]:
    """Run the controls for these mutants; marks in the baseline which tests need the whole suite.

    Raises ControlError for a control that ends wrongly, after it was yielded.
    """
    mutants = list(mutants)
    identities = _identities(baseline, mutants)
    fatals = list(_fatals(baseline, mutants))
    progress.stage("controls", len(identities) + len(fatals))
    together: list[Control] = []
    for control, wrong, result in _run(request, baseline, workers, identities):
        progress.advance(f"identity, {control.subject}: {wrong or 'survives, as it must'}")
        if wrong is None:
            yield _end(control, result)
        elif _is_whole(control, baseline):
            yield from _stop(control, wrong)
        else:
            baseline.dependent.add(control.tests)
            together.append(_whole(control, baseline))
            progress.note(f"{control.subject} pass only after other tests: judged by the whole suite")
    for control, wrong, result in _run(request, baseline, workers, [*together, *fatals]):
        progress.advance(f"{control.name}, {control.subject}: {wrong or 'as it must'}")
        yield from (_stop(control, wrong) if wrong is not None else [_end(control, result)])


def _run(
    request: Request, baseline: Baseline, workers: Workers, controls: Iterable[Control]
) -> Iterator[tuple[Control, str | None, Result]]:
    for result in workers.run(control.task(request, baseline) for control in controls):
        control: Control = result.task.key
        yield control, _wrong(control, result), result


def _identities(baseline: Baseline, mutants: list[Mutant]) -> list[Control]:
    """One identity control per selection of tests that mutants are judged by."""
    chosen: dict[tuple[str, ...], Control] = {}
    for round in range(len(baseline.tests)):
        for mutant in mutants:
            place = Place(mutant.site, mutant.operation, mutant.pattern)
            tests = baseline.selection(round, place)
            if tests and tests not in chosen:
                chosen[tests] = Control("identity", place, round, tests, _subject(tests))
    return list(chosen.values())


def _subject(tests: tuple[str, ...]) -> str:
    return tests[0] if len(tests) == 1 else f"{tests[0]} and {len(tests) - 1} more"


def _fatals(baseline: Baseline, mutants: list[Mutant]) -> Iterator[Control]:
    """One fatal control per test file: its quickest test, at a site where a mutant is planned."""
    planned = {Place(mutant.site, mutant.operation, mutant.pattern) for mutant in mutants}
    chosen: dict[str, Control] = {}
    costs: dict[str, float] = {}
    for (round, place), tests in baseline.reaching.items():
        for test in tests if place in planned else ():
            test_file, cost = test.partition("::")[0], baseline.ends[round, test].wall
            if cost < costs.get(test_file, float("inf")):
                costs[test_file] = cost
                chosen[test_file] = Control("fatal", place, round, (test,), test_file)
    yield from chosen.values()


def _is_whole(control: Control, baseline: Baseline) -> bool:
    return set(control.tests) == set(baseline.tests[control.round])


def _whole(control: Control, baseline: Baseline) -> Control:
    tests = tuple(baseline.tests[control.round])
    return Control(control.name, control.place, control.round, tests, "the whole suite")


def _wrong(control: Control, result: Result) -> str | None:
    """What is wrong with how a control ended; None if all is well."""
    if not result.ends:
        return death(result) if result.end is None else "no test ran"
    if not any(end.hits for end in result.ends):
        return "the site was not reached"
    failed = [end for end in result.ends if end.outcome == "failed"]
    if control.name == "fatal":
        return None if failed else "the test passes although the operation raises"
    if failed:
        return f"{failed[0].test} fails: {failed[0].message}"
    if len(result.ends) < len(control.tests):
        return death(result) if result.end is None else "not all tests ran"
    return None


def _end(control: Control, result: Result) -> ControlEnd:
    hits = sum(end.hits for end in result.ends)
    return ControlEnd(control.subject, control.name, True, f"{hits} hits")


def _stop(control: Control, wrong: str) -> Iterator[ControlEnd]:
    yield ControlEnd(control.subject, control.name, False, wrong)
    raise ControlError(
        f"the {control.name} control of {control.subject} at {control.place.site.place} ended wrongly: "
        f"{wrong}; no verdict of this campaign could be believed",
        control=control.name,
        test_file=control.tests[0].partition("::")[0],
    )
