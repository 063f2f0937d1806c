"""Run mutants by fork where possible and by replay otherwise.

``fork`` runs the suite once as the original and forks it where a mutant differs. ``replay`` runs each
mutant in a process of its own. With ``auto``, ``replay`` judges what ``fork`` cannot.

A test that passed in the baseline and failed in a fork parent may be flaky, or something that a fork left
behind made it fail. One more run without forks decides: a test that fails again is flaky and judges nothing.
Of one that passes, the two cannot be distinguished, so its kills are repeated.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import takewhile
from typing import TYPE_CHECKING

from mutabot.config.options import FORK, REPLAY
from mutabot.errors import in_short, plural
from mutabot.execution.task import Task
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome, Verdict
from mutabot.model.deadline import Limit

from .controls import Control, ForkTrust, controls_of, run_controls
from .forks import Unhandled, run_forks
from .replay import replay, run_alone

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign, MutantRun
    from mutabot.campaign.reuse.keys import OutcomeWriter

#: seconds for a test of the suite without any mutant
_DEADLINE = Limit(600.0)


def run_trials(
    campaign: Campaign,
    runs: Sequence[MutantRun],
    writer: OutcomeWriter,
    found: Callable[[Outcome], object] = lambda outcome: None,
    let_through: Collection[tuple[str, int]] = (),
) -> None:
    """Run these mutants in these rounds, with their controls. Each outcome is in the journal within a second.

    An outcome that counts with the whole suite only goes to ``Campaign.again`` instead.

    Args:
        found: called with each outcome. Nothing else keeps them: a campaign may have a million.
        let_through: the runs that ended without a kill when some tests were left out.

    Raises ControlError for a control that ends wrongly.
    """
    left, mutants = Unhandled(list(runs)), {mutant.id: mutant for mutant, _ in runs}
    for engine in campaign.request.engines:
        runs, left = left.runs, Unhandled()
        if not runs:
            return
        for event in _by_fork(campaign, runs, left) if engine == FORK else _by_replay(campaign, runs):
            if isinstance(event, ControlEnd):
                writer.journal.add_control(event)
                continue
            mutant = mutants[event.mutant]
            if not _counts(campaign, mutant, event):
                campaign.again.append(event)
                campaign.progress.advance(f"{_name(mutant, event)}, to be confirmed by the whole suite")
                continue
            is_confirmed = (event.mutant, event.round) in let_through
            outcome = replace(event, confirmed=True) if is_confirmed else event
            _write(campaign, mutant, outcome, writer, found)
    for mutant, round in left.runs:
        text = f"it could not be forked: {left.why(mutant) or 'its fork gave no answer'}"
        error = Outcome(mutant.id, round, Verdict.ERROR, message=text, engine=campaign.request.engine)
        _write(campaign, mutant, error, writer, found)


def _write(
    campaign: Campaign,
    mutant: Mutant,
    outcome: Outcome,
    writer: OutcomeWriter,
    found: Callable[[Outcome], object],
) -> None:
    writer.add_outcome(outcome)
    found(outcome)
    by = f" by {outcome.by}" if outcome.by is not None else ""
    campaign.progress.advance(f"{_name(mutant, outcome)}{by}")


def _runs_text(runs: Sequence[MutantRun]) -> str:
    rounds = len({round for _, round in runs})
    return "mutants" if rounds <= 1 else f"mutants × {rounds} rounds"


def _name(mutant: Mutant, outcome: Outcome) -> str:
    return f"#{mutant.number} round {outcome.round + 1}: {outcome.verdict}"


def _counts(campaign: Campaign, mutant: Mutant, outcome: Outcome) -> bool:
    """Return whether the outcome would be the same if no test had been left out."""
    if outcome.confirmed is None or outcome.verdict is Verdict.SURVIVED:
        return True
    baseline, round = campaign.baseline, outcome.round
    reaching = set(baseline.tests_reaching(round, mutant))
    first = takewhile(reaching.__contains__, baseline.tests_from_first_reach(round, mutant))
    return outcome.verdict is Verdict.REFUSED and outcome.test in list(first)


def _by_replay(campaign: Campaign, runs: Sequence[MutantRun]) -> Iterator[Outcome | ControlEnd]:
    """Run controls first, then each mutant by itself."""
    yield from run_controls(campaign, {mutant.id: mutant for mutant, _ in runs}.values())
    is_all = campaign.request.engine == REPLAY
    campaign.progress.stage(f"{_runs_text(runs)}{'' if is_all else ' by replay'}", len(runs))
    yield from replay(campaign, runs)


def _by_fork(
    campaign: Campaign, runs: Sequence[MutantRun], left: Unhandled
) -> Iterator[Outcome | ControlEnd]:
    """Run one fork parent per round, with controls and mutants as its forks."""
    mutants = {mutant.id: mutant for mutant, _ in runs}
    controls = _forked_controls(campaign, mutants.values())
    campaign.progress.stage(_runs_text(runs), len(runs))
    hindered: list[tuple[Mutant, Outcome]] = []
    trust, held = ForkTrust(campaign, controls), list[Outcome]()
    for outcome in run_forks(campaign, [*(control.run for control in controls.values()), *runs], left):
        if outcome.mutant in controls:
            yield from trust.take(outcome)
            held, ready = [], held
        elif outcome.beside is not None:
            hindered.append((mutants[outcome.mutant], outcome))
            continue
        else:
            ready = [outcome]
        for waiting in ready:
            if not trust.is_open:
                yield waiting
            elif trust.awaits(mutants[waiting.mutant], waiting):
                held.append(waiting)
            else:
                yield from _believed(trust, mutants[waiting.mutant], waiting, left)
    trust.close()
    for waiting in held:
        yield from _believed(trust, mutants[waiting.mutant], waiting, left)
    left.runs += [(mutant, outcome.round) for mutant, outcome in hindered if not trust.believes(outcome)]
    hindered = [(mutant, outcome) for mutant, outcome in hindered if trust.believes(outcome)]
    _report_replayed(campaign, left)
    clear_up(campaign, left.suspects)
    left.runs = [run for run in left.runs if run[0].id not in controls]
    yield from run_alone(campaign, hindered)


def _believed(trust: ForkTrust, mutant: Mutant, outcome: Outcome, left: Unhandled) -> Iterator[Outcome]:
    if trust.believes(outcome):
        yield outcome
    else:
        left.runs.append((mutant, outcome.round))


def _forked_controls(campaign: Campaign, mutants: Collection[Mutant]) -> dict[str, Control]:
    """Return the controls that are to be forked, by the ids of their mutants."""
    found = controls_of(campaign.baseline, mutants, forked=True)
    return {control.mutant.id: control for control in found if (FORK, *control.way) not in campaign.proven}


def try_controls(campaign: Campaign, mutants: Sequence[Mutant]) -> tuple[int, Unhandled]:
    """Run the controls alone. Return how many passed, and what ``fork`` leaves to replay.

    Raises ControlError for a control that ends wrongly.
    """
    left, ended = Unhandled(), 0
    rest = mutants
    if FORK in campaign.request.engines:
        controls = _forked_controls(campaign, mutants)
        campaign.progress.stage("controls", len(controls))
        trust = ForkTrust(campaign, controls)
        for outcome in run_forks(campaign, [control.run for control in controls.values()], left):
            ended += len(list(trust.take(outcome)))
            campaign.progress.advance()
        left.runs += [
            control.run for control in controls.values() if (FORK, *control.way) not in campaign.proven
        ]
        apart = [mutant for mutant in mutants if campaign.baseline.is_apart(mutant)]
        rest = mutants if left.runs else apart
    if REPLAY in campaign.request.engines and rest:
        ended += len(list(run_controls(campaign, rest)))
    return ended, left


def _report_replayed(campaign: Campaign, left: Unhandled) -> None:
    """Note which mutants run in processes of their own, and why."""
    tests: dict[str, list[str]] = {}
    for test, reason in left.reasons.items():
        tests.setdefault(reason, []).append(test)
    for reason, names in tests.items():
        where = f"no forks in {in_short(names, 1)}" if names[0] else "no forks while the program is imported"
        campaign.progress.note(f"{where}: {reason}; mutants there run in processes of their own")
    if left.apart:
        text = "that are active before any point at which they could be forked run in processes of their own"
        campaign.progress.note(f"{plural(len(left.apart), 'mutant')} {text}")
    for note in left.notes:
        campaign.progress.note(note)


def clear_up(campaign: Campaign, suspects: Iterable[tuple[int, str]]) -> None:
    """Run the suite again in each round with suspected flaky tests; note in the baseline which are flaky."""
    baseline, progress = campaign.baseline, campaign.progress
    by_round: dict[int, list[str]] = {}
    for round, test in suspects:
        by_round.setdefault(round, []).append(test)
    jobs = {round: campaign.request.job(round, tests=baseline.suite(round)) for round in by_round}
    for result in campaign.executor.run(Task(round, job, deadline=_DEADLINE) for round, job in jobs.items()):
        round = result.task.key
        ends = ((end, baseline.ends[round, end.test]) for end in result.ends)
        passed = {end.test for end, first in ends if end.lasting == first.lasting}
        for test in by_round[round]:
            if test not in passed:
                baseline.set_aside(round, test, "passed in the baseline, but not in equal runs")
                progress.note(f"excluded as flaky in round {round + 1}: {test}")
            else:
                baseline.doubt(test)
                progress.note(
                    f"{test} failed once while mutants were forked in round {round + 1}, and passes "
                    "without: by chance, or by what a fork left behind; mutants of this test and of later "
                    "ones run in processes of their own"
                )
