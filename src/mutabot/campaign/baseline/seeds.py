"""Further runs of the original with other seeds, to know its own spread even if mutants run with few seeds.

Its runs with seeds of rounds in which no mutant runs judge nothing. They show by how much things differ
without any fault, so that reports describe mutants by what is the same with all seeds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.campaign.baseline.baseline import Sources, observation
from mutabot.execution.task import Task
from mutabot.model.deadline import Limit

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mutabot.campaign.campaign import Campaign
    from mutabot.model import Mutant

#: seeds with which the original is run at least, where a simulator reports where things are
_SEEDS = 3


def record_more_seeds(campaign: Campaign, mutants: Iterable[Mutant]) -> None:
    """Run the tests that reach these mutants as the original with more seeds.

    Only if the rounds give few seeds, and if anything is recorded of the tests' world.
    """
    evidence, request, baseline = campaign.evidence, campaign.request, campaign.baseline
    rounds = range(request.rounds, _SEEDS)
    reaching = {test for mutant in mutants for test in baseline.tests_reaching(0, mutant)}
    tests = tuple(test for test in baseline.suite(0) if test in reaching)
    if evidence is None or not rounds or not tests or not evidence.has_tracks:
        return
    campaign.progress.stage("original with other seeds", len(rounds))
    details = {
        "known": baseline.known, "moments": baseline.probe_intervals.get(0, {}),
        "tests": tests, "aside": baseline.aside(0, tests),
    }  # fmt: skip
    tasks = (
        Task((round, 0), request.job(round, record=True, **details), startup=Limit(300.0)) for round in rounds
    )
    sources = Sources(request.root)
    for result in campaign.executor.run(tasks):
        ends, places = [end for end in result.ends if end.outcome == "passed"], sources.places(result.sites)
        evidence.add_seed(result.task.key[0], ends)
        baseline.add_seed({end.test: observation(end, places) for end in ends})
        campaign.progress.advance()
