"""Suspects: tests that passed in the baseline and failed in a trunk.

A trunk runs the quickest tests first, so a test that needs an earlier one fails there without being flaky.
The whole suite in its own order tells the two apart: a test that passes in it depends on others, and its
mutants are judged by the whole suite; one that fails again is flaky and judges nothing.
"""

from __future__ import annotations

from collections.abc import Iterable

from .baseline import Baseline
from .request import Progress, Request
from .workers import Task, Workers

#: seconds for a test of the suite without any mutant
_DEADLINE = 600.0


def clear_up(
    request: Request,
    baseline: Baseline,
    workers: Workers,
    progress: Progress,
    suspects: Iterable[tuple[int, str]],
) -> None:
    """Run the suite once more in each round that has suspects, and note in the baseline what they are."""
    by_round: dict[int, list[str]] = {}
    for round, test in suspects:
        by_round.setdefault(round, []).append(test)
    tasks = [
        Task(round, request.job(round, tests=tuple(baseline.tests[round])), deadline=_DEADLINE)
        for round in by_round
    ]
    for result in workers.run(tasks):
        round = result.task.job.round
        passed = {end.test for end in result.ends if end.lasting == baseline.ends[round, end.test].lasting}
        for test in by_round[round]:
            if test in passed:
                progress.note(
                    f"{test} passes only after other tests: its mutants are judged by the whole suite"
                )
                baseline.judge_by_whole_suite(round, test)
            else:
                baseline.set_aside(round, test, "passed in the baseline, but not in equal runs")
                progress.note(f"set aside as flaky in round {round + 1}: {test}")
