"""Controls: per test file, a mutant that must survive and one that must die.

They prove that the machinery changes nothing by itself, and that turning a mutant on changes anything at
all. A control that ends wrongly stops the campaign: its verdicts could not be believed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from mutabot.errors import ControlError
from mutabot.model import Mutant
from mutabot.operators.control import FatalFault
from mutabot.operators.registry import CONTROLS

from .baseline import Baseline, Place, death
from .replay import task
from .request import Progress, Request
from .workers import Result, Task, Workers

_FATAL = f"{FatalFault.__module__}:{FatalFault.__qualname__}"


@dataclass(frozen=True, slots=True)
class ControlEnd:
    """How a control ended."""

    test_file: str
    control: str
    detail: str


def run_controls(
    request: Request, baseline: Baseline, workers: Workers, progress: Progress
) -> Iterator[ControlEnd]:
    """Run the controls of every test file that reaches a site.

    Raises ControlError for the first that ends wrongly.
    """
    tasks = list(_tasks(request, baseline))
    progress.stage("controls", len(tasks))
    for result in workers.run(tasks):
        mutant = result.task.job.mutant
        assert mutant is not None
        test_file = (result.task.job.tests or ("",))[0].partition("::")[0]
        wrong = _wrong(mutant.operator, result)
        if wrong is not None:
            raise ControlError(
                f"the {mutant.operator} control of {test_file} at {mutant.site.place} ended wrongly: "
                f"{wrong}; "
                "no verdict of this campaign could be believed",
                control=mutant.operator,
                test_file=test_file,
            )
        progress.advance(f"control {mutant.operator} of {test_file}: as it must")
        yield ControlEnd(test_file, mutant.operator, _summary(result))


def _tasks(request: Request, baseline: Baseline) -> Iterator[Task]:
    for place, test, round in _choices(baseline).values():
        for name in CONTROLS:
            mutant = Mutant(0, "control", name, place.site, place.operation, place.pattern, None, "", name)
            yield task(request, baseline, mutant, round, (test,))


def _choices(baseline: Baseline) -> dict[str, tuple[Place, str, int]]:
    """Per test file, its quickest test that reaches any site, and the first site it reaches."""
    chosen: dict[str, tuple[Place, str, int]] = {}
    costs: dict[str, float] = {}
    for (round, place), tests in baseline.reaching.items():
        for test in tests:
            test_file, cost = test.partition("::")[0], baseline.ends[round, test].wall
            if cost < costs.get(test_file, float("inf")):
                chosen[test_file], costs[test_file] = (place, test, round), cost
    return chosen


def _wrong(control: str, result: Result) -> str | None:
    """What is wrong with how a control ended; None if all is well."""
    if not result.ends:
        return death(result) if result.end is None else "no test ran"
    end = result.ends[0]
    if end.hits == 0:
        return "the site was not reached"
    if control == "identity":
        return None if end.outcome == "passed" else f"the test fails: {end.message}"
    if end.outcome != "failed":
        return "the test passes although the operation raises"
    return None


def _summary(result: Result) -> str:
    end = result.ends[0]
    fatal = end.exception == _FATAL
    return f"{end.outcome} after {end.hits} hits{' by the planted fault' if fatal else ''}"
