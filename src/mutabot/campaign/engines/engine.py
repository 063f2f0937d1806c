"""The engines, which give mutants their outcomes, and what one leaves to the other.

``fork`` runs the suite once as the original and forks it where a mutant differs. ``replay`` runs each
mutant in a process of its own: it is the reference, and it takes every mutant. With ``auto``, ``replay``
judges what ``fork`` cannot.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from itertools import takewhile

from mutabot.campaign.campaign import Campaign, OutcomeWriter
from mutabot.campaign.request import FORK, REPLAY
from mutabot.errors import in_short
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome, Verdict

from .controls import Control, controls_of, run_controls, settled
from .fork_parent import ForkParents, Unhandled
from .isolated_run import MutantRun, replay, run_alone
from .rerun import clear_up


def run_trials(
    campaign: Campaign,
    runs: Sequence[MutantRun],
    writer: OutcomeWriter,
    found: Callable[[Outcome], object] = lambda outcome: None,
    let_through: Collection[tuple[str, int]] = (),
) -> None:
    """Run these mutants in these rounds, with their controls. Each outcome is in the journal within a second.

    An outcome that counts with the whole suite only goes to ``campaign.again`` instead.

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
        for one in _by_fork(campaign, runs, left) if engine == FORK else _by_replay(campaign, runs):
            if isinstance(one, ControlEnd):
                writer.journal.add_control(one.test_file, one.control, one.ok, one.detail)
                continue
            mutant = mutants[one.mutant]
            if not _counts(campaign, mutant, one):
                campaign.again.append(one)
                campaign.progress.advance(f"{_name(mutant, one)}, which the whole suite has yet to say")
                continue
            is_confirmed = (one.mutant, one.round) in let_through
            outcome = replace(one, confirmed=True) if is_confirmed else one
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


def _name(mutant: Mutant, outcome: Outcome) -> str:
    return f"#{mutant.number} round {outcome.round + 1}: {outcome.verdict}"


def _counts(campaign: Campaign, mutant: Mutant, outcome: Outcome) -> bool:
    """Whether no test was left out whose absence may have led to this outcome."""
    if outcome.confirmed is None or outcome.verdict is Verdict.SURVIVED:
        return True
    baseline, round = campaign.baseline, outcome.round
    reaching = set(baseline.tests_reaching(round, mutant))
    first = takewhile(reaching.__contains__, baseline.tests_judging(round, mutant))
    return outcome.verdict is Verdict.REFUSED and outcome.test in list(first)


def _by_replay(campaign: Campaign, runs: Sequence[MutantRun]) -> Iterator[Outcome | ControlEnd]:
    """Run controls first, then each mutant by itself."""
    yield from run_controls(campaign, {mutant.id: mutant for mutant, _ in runs}.values())
    is_all = campaign.request.engine == REPLAY
    campaign.progress.stage("mutants" if is_all else "mutants by replay", len(runs))
    yield from replay(campaign, runs)


def _by_fork(
    campaign: Campaign, runs: Sequence[MutantRun], left: Unhandled
) -> Iterator[Outcome | ControlEnd]:
    """Run one fork parent per round, with controls and mutants as its forks."""
    mutants = {mutant.id: mutant for mutant, _ in runs}
    controls = _forked_controls(campaign, mutants.values())
    campaign.progress.stage("mutants", len(runs))
    parents = ForkParents(campaign, left)
    hindered: list[tuple[Mutant, Outcome]] = []
    for outcome in parents.run([*(one.run for one in controls.values()), *runs]):
        if outcome.mutant in controls:
            yield from settled(campaign, FORK, controls[outcome.mutant], outcome)
        elif outcome.beside is not None:
            hindered.append((mutants[outcome.mutant], outcome))
        else:
            yield outcome
    _tell(campaign, left)
    clear_up(campaign, parents.suspects)
    left.runs = [run for run in left.runs if run[0].id not in controls]
    yield from run_alone(campaign, hindered)


def _forked_controls(campaign: Campaign, mutants: Collection[Mutant]) -> dict[str, Control]:
    """The controls that are to be forked, by the ids of their mutants."""
    found = controls_of(campaign.baseline, mutants, forked=True)
    return {one.mutant.id: one for one in found if (FORK, *one.way) not in campaign.proven}


def try_controls(campaign: Campaign, mutants: Sequence[Mutant]) -> tuple[int, Unhandled]:
    """Run the controls alone. Returns how many ended as they must, and what ``fork`` leaves.

    Raises ControlError for a control that ends wrongly.
    """
    left, ended = Unhandled(), 0
    rest = mutants
    if FORK in campaign.request.engines:
        controls = _forked_controls(campaign, mutants)
        campaign.progress.stage("controls", len(controls))
        for outcome in ForkParents(campaign, left).run([one.run for one in controls.values()]):
            ended += len(list(settled(campaign, FORK, controls[outcome.mutant], outcome, is_step=True)))
        apart = [one for one in mutants if campaign.baseline.is_apart(one)]
        rest = mutants if left.runs else apart
    if REPLAY in campaign.request.engines and rest:
        ended += len(list(run_controls(campaign, rest)))
    return ended, left


def _tell(campaign: Campaign, left: Unhandled) -> None:
    """Say what runs in processes of its own, and why."""
    tests: dict[str, list[str]] = {}
    for test, reason in left.reasons.items():
        tests.setdefault(reason, []).append(test)
    for reason, names in tests.items():
        during = "no forks while the program is imported"
        where = f"no forks in {in_short(names, 1)}" if names[0] else during
        campaign.progress.note(f"{where}: {reason}; mutants there run in processes of their own")
    if left.apart:
        text = "each is in place from the start of each test, in a process of its own"
        campaign.progress.note(f"{len(left.apart)} mutants: {text}")
    for note in left.notes:
        campaign.progress.note(note)
