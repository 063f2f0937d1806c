"""Suspects: tests that passed in the baseline and failed in a trunk.

A trunk runs the quickest tests first, and branches mutants off, so a test can fail there without being
flaky. Two more runs without branches tell why: the whole suite in its own order, and the trunk's tests in
the trunk's. A test that fails again in the former is flaky and judges nothing. One that fails again only in
the latter depends on others, and its mutants are judged by the whole suite. One that passes in both has
failed by chance, or by what a branch left behind: that cannot be told apart, so its kills are repeated.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from mutabot.campaign.campaign import Campaign
from mutabot.campaign.workers.task import Task

#: seconds for a test of the suite without any mutant
_DEADLINE = 600.0


@dataclass(frozen=True, slots=True)
class _Order:
    """Which run: the key of its task."""

    round: int
    in_trunks_order: bool


def clear_up(
    campaign: Campaign, suspects: Iterable[tuple[int, str]], orders: Mapping[int, tuple[str, ...]]
) -> None:
    """Run the tests twice more in each round that has suspects, and note in the baseline what they are.

    ``orders``: per round, the tests of the trunk in its order.
    """
    request, baseline = campaign.request, campaign.baseline
    by_round: dict[int, list[str]] = {}
    for round, test in suspects:
        by_round.setdefault(round, []).append(test)
    tasks = [
        Task(_Order(round, in_trunks_order), request.job(round, tests=tests), deadline=_DEADLINE)
        for round in by_round
        for in_trunks_order, tests in ((False, tuple(baseline.tests[round])), (True, orders[round]))
    ]
    passed: dict[_Order, set[str]] = {}
    for result in campaign.executor.run(tasks):
        run: _Order = result.task.key
        ends = ((end, baseline.ends[run.round, end.test]) for end in result.ends)
        passed[run] = {end.test for end, first in ends if end.lasting == first.lasting}
    for round, tests in by_round.items():
        for test in tests:
            in_suite, in_order = (test in passed[_Order(round, trunks)] for trunks in (False, True))
            _clear_up_one(campaign, round, test, in_suite=in_suite, in_order=in_order)


def _clear_up_one(campaign: Campaign, round: int, test: str, *, in_suite: bool, in_order: bool) -> None:
    """What is known of a suspect from whether it passes in the suite's order, and in the trunk's."""
    baseline, progress = campaign.baseline, campaign.progress
    if not in_suite:
        baseline.set_aside(round, test, "passed in the baseline, but not in equal runs")
        progress.note(f"set aside as flaky in round {round + 1}: {test}")
    elif in_order:
        baseline.doubt(test)
        progress.note(
            f"{test} failed once while mutants were branched off in round {round + 1}, and passes without: "
            "by chance, or by what a branch left behind; its mutants run in processes of their own"
        )
    else:
        progress.note(f"{test} passes only after other tests: its mutants are judged by the whole suite")
        baseline.passes_only_after_others(round, test)
