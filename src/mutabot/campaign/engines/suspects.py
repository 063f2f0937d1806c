"""Suspects: tests that passed in the baseline and failed in a trunk.

A trunk runs the suite as the baseline did, so such a test may be flaky; or something that a branch left
behind made it fail. One more run without branches tells: a test that fails again is flaky and judges nothing.
Of one that passes, that cannot be told apart, so its kills are repeated.
"""

from __future__ import annotations

from collections.abc import Iterable

from mutabot.campaign.campaign import Campaign
from mutabot.campaign.workers.task import Task

#: seconds for a test of the suite without any mutant
_DEADLINE = 600.0


def clear_up(campaign: Campaign, suspects: Iterable[tuple[int, str]]) -> None:
    """Run the suite once more in each round that has suspects, and note in the baseline what they are."""
    request, baseline, progress = campaign.request, campaign.baseline, campaign.progress
    by_round: dict[int, list[str]] = {}
    for round, test in suspects:
        by_round.setdefault(round, []).append(test)
    tasks = [
        Task(round, request.job(round, tests=baseline.suite(round)), deadline=_DEADLINE) for round in by_round
    ]
    for result in campaign.executor.run(tasks):
        round = result.task.key
        ends = ((end, baseline.ends[round, end.test]) for end in result.ends)
        passed = {end.test for end, first in ends if end.lasting == first.lasting}
        for test in by_round[round]:
            if test not in passed:
                baseline.set_aside(round, test, "passed in the baseline, but not in equal runs")
                progress.note(f"set aside as flaky in round {round + 1}: {test}")
            else:
                baseline.doubt(test)
                progress.note(
                    f"{test} failed once while mutants were branched off in round {round + 1}, and passes "
                    "without: by chance, or by what a branch left behind; mutants of this test and of later "
                    "ones run in processes of their own"
                )
