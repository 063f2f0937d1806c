"""The engine that runs each mutant in a process of its own: the reference, which takes every mutant."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from mutabot.campaign.verdict import judge_safely, not_judged, run_of, without_tests
from mutabot.config.options import REPLAY

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign, MutantRun
    from mutabot.execution.task import Task
    from mutabot.model import Mutant, Outcome


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
    """Re-run, with no other task in parallel, the runs that other load delayed. These outcomes are final."""
    if not hindered:
        return
    first = {(outcome.mutant, outcome.round): outcome for _, outcome in hindered}
    changed = 0
    for _, outcome in _run(campaign, [(mutant, outcome.round) for mutant, outcome in hindered], alone=True):
        before = first[outcome.mutant, outcome.round]
        changed += outcome.verdict is not before.verdict
        yield replace(outcome, beside=before.beside)
    count = len(hindered)
    campaign.progress.note(
        f"{count} {'run' if count == 1 else 'runs'} that ended by the wall clock while the machine was busy "
        f"{'was' if count == 1 else 'were'} re-run alone; {changed} of {count} changed"
    )


def _run(
    campaign: Campaign, runs: Iterable[MutantRun], *, alone: bool = False
) -> Iterator[tuple[Mutant, Outcome]]:
    uncovered: list[MutantRun] = []

    def tasks() -> Iterator[Task]:
        for mutant, round in runs:
            if campaign.baseline.tests_reaching(round, mutant):
                made = campaign.task(mutant, round, campaign.baseline.suite(round))
                yield replace(made, alone=alone or made.alone)
            else:
                uncovered.append((mutant, round))

    for result in campaign.executor.run(tasks()):
        mutant, round = result.task.key
        try:
            yield mutant, judge_safely(campaign, run_of(result, campaign.sources))
        except Exception as error:
            yield mutant, not_judged(mutant, round, error, REPLAY)
    for mutant, round in uncovered:
        yield mutant, without_tests(campaign.baseline, mutant, round)
