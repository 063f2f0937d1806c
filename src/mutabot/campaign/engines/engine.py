"""The engines put to work: branch where it is safe to fork, replay where it is not."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

from mutabot.campaign.baseline.baseline import REPETITIONS, Baseline
from mutabot.campaign.baseline.order_dependence import clear_up
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.sink import Sink
from mutabot.campaign.workers.workers import Workers
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome, Verdict

from .branch import Remainder, branch
from .controls import Control, controls_in_branches, end_of, run_controls
from .replay import Pair, replay


def engine_of(request: Request) -> str:
    """The engine that ``auto`` means: branch."""
    return "replay" if request.engine == "replay" else "branch"


def repetitions_for(request: Request) -> int:
    """How often the baseline runs each round; the trunks of the branch engine are its second run.

    More than that, if it was asked for: a test that fails at random shows itself the sooner.
    """
    least = REPETITIONS if engine_of(request) == "replay" else REPETITIONS - 1
    return max(least, request.baseline or 0)


def run_mutants(
    request: Request,
    baseline: Baseline,
    workers: Workers,
    progress: Progress,
    mutants: Sequence[Mutant],
    sink: Sink,
    done: Collection[tuple[str, int]] = (),
) -> None:
    """Run controls and mutants in all rounds; every outcome is in the journal as soon as it is known.

    ``done`` are the ids and rounds that need not be run.

    Raises ControlError for a control that ends wrongly.
    """
    pairs = [
        (mutant, round)
        for round in range(request.rounds)
        for mutant in mutants
        if (mutant.id, round) not in done
    ]
    if not pairs:
        return
    report = _Report(progress, sink, {mutant.id: mutant.number for mutant in mutants})
    if engine_of(request) == "branch":
        pairs = _branched(request, baseline, workers, report, pairs)
    if not pairs:
        return
    needed = list({mutant.id: mutant for mutant, _ in pairs}.values())
    for end in run_controls(request, baseline, workers, progress, needed):
        report.control(end)
    progress.stage("mutants" if engine_of(request) == "replay" else "mutants by replay", len(pairs))
    for outcome in replay(request, baseline, workers, pairs):
        report.outcome(outcome)


def try_controls(
    request: Request, baseline: Baseline, workers: Workers, progress: Progress, mutants: Sequence[Mutant]
) -> tuple[int, Remainder]:
    """Run the controls alone: how many ended as they must, and in which tests it is not safe to fork.

    Raises ControlError for a control that ends wrongly.
    """
    remainder = Remainder()
    ended = 0
    if engine_of(request) == "branch":
        controls = controls_in_branches(baseline, mutants)
        for mutant, round in ((mutant, round) for mutant in mutants for round in range(request.rounds)):
            forbidding = baseline.why_not_branch(round, baseline.judges(round, mutant))
            if forbidding is not None:
                remainder.leave(mutant, round, *forbidding)
        progress.stage("controls", len(controls))
        ended = sum(1 for _ in _controls(request, baseline, workers, controls, remainder, progress))
        mutants = [mutant for mutant in mutants if remainder.pairs or baseline.is_early(mutant)]
    if mutants:
        ended += sum(1 for _ in run_controls(request, baseline, workers, progress, mutants))
    return ended, remainder


class _Report:
    """Outcomes and controls on their way to the journal and the screen."""

    def __init__(self, progress: Progress, sink: Sink, numbers: dict[str, int]) -> None:
        self.progress, self._sink, self._numbers = progress, sink, numbers

    def outcome(self, outcome: Outcome) -> None:
        self._sink.add_outcome(outcome)
        by = f" by {outcome.by}" if outcome.by is not None else ""
        number = self._numbers[outcome.mutant]
        self.progress.advance(f"#{number} round {outcome.round + 1}: {outcome.verdict}{by}")

    def control(self, end: ControlEnd) -> None:
        self._sink.journal.add_control(end.test_file, end.control, end.ok, end.detail)


def _branched(
    request: Request, baseline: Baseline, workers: Workers, report: _Report, pairs: list[Pair]
) -> list[Pair]:
    """Run by branching what can be; returns what is left to replay."""
    controls = controls_in_branches(baseline, [mutant for mutant, _ in pairs])
    by_id = {control.mutant.id: control for control in controls}
    only = {mutant: control.tests for mutant, control in by_id.items()}
    first = [(control.mutant, control.round) for control in controls]
    remainder = Remainder()
    report.progress.stage("mutants", len(pairs))
    for outcome in branch(request, baseline, workers, [*first, *pairs], remainder, only=only):
        if outcome.mutant in by_id:
            control = by_id[outcome.mutant]
            end = end_of(control, outcome, request, baseline, report.progress)
            report.control(end)
            if not end.ok:
                raise control.error(end.detail)
        else:
            report.outcome(outcome)
    _note(report.progress, remainder)
    clear_up(request, baseline, workers, report.progress, remainder.suspects, remainder.orders)
    rest = [(mutant, round) for mutant, round in remainder.pairs if mutant.id not in by_id]
    rest += remainder.early
    if request.engine == "branch":
        for outcome in _refused(rest, remainder):
            report.outcome(outcome)
        return []
    return rest


def _controls(
    request: Request,
    baseline: Baseline,
    workers: Workers,
    controls: list[Control],
    remainder: Remainder,
    progress: Progress,
) -> Iterator[ControlEnd]:
    by_id = {control.mutant.id: control for control in controls}
    only = {mutant: control.tests for mutant, control in by_id.items()}
    pairs = [(control.mutant, control.round) for control in controls]
    for outcome in branch(request, baseline, workers, pairs, remainder, only=only):
        control = by_id[outcome.mutant]
        end = end_of(control, outcome, request, baseline, progress)
        progress.advance(f"{control.name}, {control.subject}: {'as it must' if end.ok else end.detail}")
        if not end.ok:
            raise control.error(end.detail)
        yield end


def _note(progress: Progress, remainder: Remainder) -> None:
    for test, reason in remainder.reasons.items():
        progress.note(f"no branches in {test}: {reason}; its mutants run in processes of their own")
    if remainder.early:
        number = len({mutant.id for mutant, _ in remainder.early})
        progress.note(
            f"{number} mutants act while the program is imported: each runs in a process of its own"
        )
    for note in remainder.notes:
        progress.note(note)


def _refused(pairs: Iterable[Pair], remainder: Remainder) -> Iterator[Outcome]:
    """With ``--engine branch`` nothing is replayed: what could not be branched is an error."""
    reasons = "; ".join(dict.fromkeys([*remainder.reasons.values(), *remainder.notes]))
    early = {mutant.id for mutant, _ in remainder.early}
    for mutant, round in pairs:
        why = "it acts while the program is imported" if mutant.id in early else reasons
        text = f"it could not be branched: {why or 'its branch gave no answer'}"
        yield Outcome(mutant.id, round, Verdict.ERROR, message=text, engine="branch")
