"""The campaign: baseline, plan, what still holds, controls, engine; and the journal from the first moment."""

from __future__ import annotations

import errno
import platform
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from mutabot import __version__
from mutabot.border.codec import to_data
from mutabot.campaign.baseline.baseline import Baseline, take_baseline
from mutabot.campaign.baseline.program_text import family_of
from mutabot.campaign.baseline.ranges import note_ranges
from mutabot.campaign.baseline.unfit import refuse_unfit
from mutabot.campaign.engines.branch import Remainder
from mutabot.campaign.engines.engine import engine_of, repetitions_for, run_mutants, try_controls
from mutabot.campaign.engines.repeats import look_again
from mutabot.campaign.engines.second_look import refuse_flaky
from mutabot.campaign.plan.earlier import carry, note_outdated
from mutabot.campaign.plan.plan import Plan, make_plan
from mutabot.campaign.plan.sampling import draw
from mutabot.campaign.plan.second_order import pairs
from mutabot.campaign.plan.selection import numbered, select
from mutabot.campaign.reuse.keys import Dependencies
from mutabot.campaign.reuse.opened import Watch
from mutabot.campaign.reuse.reuse import reuse
from mutabot.campaign.reuse.snapshot import Snapshot
from mutabot.campaign.workers.interruption import interruptions_kept
from mutabot.campaign.workers.workers import Result, Workers
from mutabot.errors import JournalError, NothingToDoError
from mutabot.journal.journal import Journal
from mutabot.journal.lock import at_work
from mutabot.journal.records import DRAWING
from mutabot.model import LeftOut, Mutant, Vocabulary
from mutabot.vocabulary.load import shipped

from .request import CheckReport, Progress, Request
from .sink import Sink

#: what else decides how a campaign ends, beside the user's own files
_VERSIONS = ("pytest", "wrapt", "mujoco", "mink", "ruckig", "numpy", "pytest-bdd")


def run_campaign(request: Request, progress: Progress) -> Path:
    """Run a whole campaign and return the path of its journal.

    Outcomes of earlier campaigns that still hold are taken over. New ones are in the journal as soon as
    they are known; an interrupted campaign leaves what it has.

    Raises ConfigurationError, BaselineError, NothingToDoError, ControlError, JournalError.
    """
    started = time.monotonic()
    with (
        interruptions_kept(),
        Journal.prepare(request.journal_path, meta=_meta(request)) as journal,
    ):
        try:
            with _disk_told(request), _workers(request) as workers:
                _run(request, workers, progress, journal)
            journal.set_meta("seconds", time.monotonic() - started)
            journal.finish("complete")
        except BaseException as error:
            with suppress(JournalError):  # on a full disk not even this can be written
                journal.finish(_reason(error))
            raise
    return request.journal_path


def _run(request: Request, workers: Workers, progress: Progress, journal: Journal) -> None:
    started = time.monotonic()
    before = Snapshot.take(request.root)
    with Watch(request.root, before.folders) as watch:
        baseline, results = _baseline(request, workers, progress)
    whole = make_plan(baseline, request.vocabulary, request.families)
    plan = selected(request, whole, baseline)
    _write_beginning(journal, request, results, plan, whole)
    _note_unstable(baseline, progress)
    refuse_flaky(request, baseline)
    after = Snapshot.take(request.root, before)
    edited = after.edited_programs(before)
    if edited:
        progress.note(f"{_listed(edited)} changed during the baseline: no outcome is reused, now or later")
        sink = Sink(journal)
        run_mutants(request, baseline, workers, progress, plan.mutants, sink)
        look_again(request, baseline, workers, progress, plan.mutants, sink, time.monotonic() - started)
        return
    dependencies = Dependencies(request, baseline, _collected(results), before, after, watch.opened)
    note_outdated(journal, request, dependencies)
    done = reuse(journal, dependencies, plan.mutants, request.rounds, progress)
    sink = Sink(journal, _key_of(journal, dependencies, plan))
    try:
        run_mutants(request, baseline, workers, progress, plan.mutants, sink, done)
        look_again(request, baseline, workers, progress, plan.mutants, sink, time.monotonic() - started)
    finally:
        _forget_if_edited(request, journal, progress, dependencies, after)
    _tidy(request, journal, whole)


def _tidy(request: Request, journal: Journal, whole: Plan) -> None:
    """Forget mutants that the program has no longer; of other families and orders nothing is known now."""
    if request.order == 1:
        known = {mutant.id for mutant, _ in journal.known()}
        others = {mutant for mutant, _ in journal.kept() if family_of(mutant) not in request.families}
        journal.tidy([*others, *known, *(mutant.id for mutant in whole.mutants)])


def _collected(results: Sequence[Result]) -> set[str]:
    """All tests that the baseline knows of, also those it set aside."""
    ends = (result.end for result in results)
    return {test for end in ends if end is not None for test in end.collected}


def _key_of(journal: Journal, dependencies: Dependencies, plan: Plan) -> Callable[[str, int], str]:
    by_id = {mutant.id: mutant for mutant in plan.mutants}

    def key_of(mutant: str, round: int) -> str:
        key = dependencies.keys(by_id[mutant], round)[0]
        journal.add_parts(dependencies.new_parts())
        return key

    return key_of


def _forget_if_edited(
    request: Request, journal: Journal, progress: Progress, dependencies: Dependencies, after: Snapshot
) -> None:
    """Outcomes that may come from two versions of a file are not reused."""
    edited = Snapshot.take(request.root, after).edited_since(dependencies.files)
    if edited:
        progress.note(f"{_listed(edited)} changed while mutants ran: what was found will not be reused")
        with suppress(JournalError):
            journal.forget_keys()


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return ", ".join(names[:3]) + more


@contextmanager
def _disk_told(request: Request) -> Iterator[None]:
    """A disk that cannot be written is the user's concern, not a fault of ours."""
    try:
        yield
    except OSError as error:
        if error.errno not in {errno.ENOSPC, errno.EDQUOT, errno.EROFS}:
            raise
        home = request.journal_path.parent
        text = (
            f"{error.filename or home} cannot be written: {error.strerror}; what was reported before is kept"
        )
        raise JournalError(text, path=str(request.journal_path)) from error


def plan_only(request: Request, progress: Progress) -> tuple[list[Mutant], list[LeftOut]]:
    """Baseline and plan, without running a mutant."""
    with _workers(request) as workers:
        baseline, _ = _baseline(request, workers, progress)
    plan = selected(request, make_plan(baseline, request.vocabulary, request.families), baseline)
    return plan.mutants, plan.left_out


def check(request: Request, progress: Progress) -> CheckReport:
    """Try the whole set-up, controls included, without running mutants."""
    with _workers(request) as workers:
        baseline, _ = _baseline(request, workers, progress)
        plan = make_plan(baseline, request.vocabulary, request.families)
        mutants = selected(request, plan, baseline).mutants
        controls, remainder = try_controls(request, baseline, workers, progress, mutants)
    return _report(request, baseline, plan, mutants, controls, remainder)


def _baseline(request: Request, workers: Workers, progress: Progress) -> tuple[Baseline, list[Result]]:
    branches = engine_of(request) == "branch"
    workers.on_unshared = lambda reason: progress.note(
        f"each run starts anew, imports and collection included: {reason}"
    )
    repetitions = repetitions_for(request)
    baseline, results = take_baseline(request, workers, progress, repetitions=repetitions, may_share=branches)
    refuse_unfit(baseline, request.vocabulary)
    note_ranges(baseline, request.vocabulary, progress)
    return baseline, results


def selected(request: Request, plan: Plan, baseline: Baseline) -> Plan:
    """The plan with the mutants that were asked for.

    Raises NothingToDoError if none is left, saying why.
    """
    if not plan.mutants:
        raise NothingToDoError(_why_no_mutants(request, plan, baseline))
    mutants = select(plan.mutants, request.only, request.skip, request.selection, left_out=plan.left_out)
    if not mutants:
        raise NothingToDoError("the selection leaves no mutant to run")
    if request.order == 2:
        mutants = pairs(baseline, mutants, request.pairs, request.seed)
        if not mutants:
            raise NothingToDoError("no test reaches two mutants of this selection at different places")
    if request.sample is None and not request.one_per_site:
        return Plan(mutants, plan.left_out)
    drawn, drawing = draw(mutants, request.seed, sample=request.sample, one_per_site=request.one_per_site)
    return Plan(drawn, plan.left_out, drawing)


@contextmanager
def _workers(request: Request) -> Iterator[Workers]:
    with (
        interruptions_kept(),
        at_work(request.journal_path.parent),
        Workers(request.root, request.arguments, request.jobs) as workers,
    ):
        yield workers


def _why_no_mutants(request: Request, plan: Plan, baseline: Baseline) -> str:
    of_text = Counter(item.reason for item in baseline.program.left_out)
    if of_text:
        reason, count = of_text.most_common(1)[0]
        return f"no mutants: all {len(plan.left_out)} are left out, {count} of them because {reason}"
    if not baseline.hits:
        files = ", ".join((*request.configuration.program, *request.configuration.oracle))
        return f"no mutants: no test reaches a call of the vocabulary's operations in {files}"
    return f"no mutants: all {len(plan.left_out)} would change nothing"


def _write_beginning(
    journal: Journal, request: Request, results: Sequence[Result], plan: Plan, whole: Plan
) -> None:
    """From here on the journal is that of this campaign."""
    journal.begin(_meta(request))
    for result in results:
        for end in result.ends:
            journal.add_test(result.task.key.round, result.task.key.repetition, end)
    numbers = numbered(whole.mutants, request.selection, left_out=whole.left_out)
    known = [mutant for mutant, _ in journal.known()]
    carried = carry(known, request, plan.mutants, [*whole.mutants, *numbers])
    paths = {file: request.root / file for file in {m.site.span.file for m in (*plan.mutants, *carried)}}
    sources = {
        file: path.read_text(encoding="utf-8", errors="replace")
        for file, path in paths.items()
        if path.is_file()
    }
    journal.set_plan(plan.mutants, plan.left_out, sources=sources)
    journal.set_known((mutant, True) for mutant in carried)
    if request.fresh:
        journal.forget(mutant.id for mutant in plan.mutants)
    if plan.drawing is not None:
        journal.set_meta(DRAWING, to_data(plan.drawing))


def _note_unstable(baseline: Baseline, progress: Progress) -> None:
    for (round, test), reason in baseline.unstable.items():
        progress.note(f"set aside in round {round + 1}: {test} ({reason})")


def _reason(error: BaseException) -> str:
    return "interrupted" if isinstance(error, KeyboardInterrupt) else f"{type(error).__name__}: {error}"


def _meta(request: Request) -> dict[str, Any]:
    return {
        "mutabot": __version__,
        "python": platform.python_version(),
        "versions": _versions(),
        "root": str(request.root),
        "seed": request.seed,
        "rounds": request.rounds,
        "engine": engine_of(request),
        "jobs": request.jobs,
        "families": list(request.families),
        "order": request.order,
        "pairs": request.pairs,
        "every_test": request.every_test,
        "no_oracle": request.no_oracle,
        "fresh": request.fresh,
        "started": time.time(),
        "vocabulary": to_data(request.vocabulary),
    }


def _versions() -> dict[str, str]:
    found = {}
    for name in _VERSIONS:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def _report(
    request: Request,
    baseline: Baseline,
    plan: Plan,
    mutants: list[Mutant],
    controls: int,
    remainder: Remainder,
) -> CheckReport:
    tests = sorted({test for round in range(request.rounds) for test in baseline.ran(round)})
    never = _never_called(request.vocabulary, baseline)
    lines = [
        f"tests     {len(tests)} pass in {request.rounds} rounds"
        + (f", {baseline.skipped} skipped" if baseline.skipped else ""),
        f"sites     {len({place.site for place in baseline.places})} reached",
        f"controls  {controls} ended as they must",
        f"mutants   {len(mutants)}"
        + (f" selected of {len(plan.mutants)}" if len(mutants) != len(plan.mutants) else "")
        + f", {len(plan.left_out)} left out because they {_why_left_out(baseline)}",
    ]
    lines += [
        f"flaky     {test} in round {round + 1}: {why}" for (round, test), why in baseline.unstable.items()
    ]
    lines += [
        f"restless  {test} in round {round + 1}: equal runs differ in values"
        for round, test in sorted(baseline.restless)
    ]
    lines += _unused(request.vocabulary, never)
    clock = request.vocabulary.clock
    if clock is not None and all(end.simulated is None for end in baseline.ends.values()):
        lines.append(f"unused    clock: no test calls {clock.tick}, so there is no simulated time")
    lines += [f"note      {remark}" for remark in baseline.remarks]
    lines += [f"replay    {test}: {why}" for test, why in remainder.reasons.items()]
    data = {
        "replay": dict(remainder.reasons),
        "tests": tests,
        "sites": [place.key for place in baseline.places],
        "mutants": len(mutants),
        "planned": len(plan.mutants),
        "left_out": len(plan.left_out),
        "controls": controls,
        "unstable": [{"round": r, "test": t, "reason": why} for (r, t), why in baseline.unstable.items()],
        "restless": [{"round": r, "test": t} for r, t in sorted(baseline.restless)],
        "unused": never,
        "remarks": [to_data(remark) for remark in baseline.remarks],
    }
    return CheckReport(lines, data)


def _why_left_out(baseline: Baseline) -> str:
    return "cannot matter" if baseline.program.left_out else "would change nothing"


def _unused(vocabulary: Vocabulary, never: Sequence[str]) -> Iterator[str]:
    """Operations that no test reaches; of a shipped vocabulary nobody uses all, so one line is enough."""
    of = {operation.target: operation.source.partition(":")[0] for operation in vocabulary.operations}
    ours = set(shipped())
    yield from (
        f"unused    {target}: no test reaches it from the program or the oracle"
        for target in never
        if of[target] not in ours
    )
    for name in sorted({of[target] for target in never} & ours):
        there = sum(other == name for other in of.values())
        unused = sum(of[target] == name for target in never)
        yield f"unused    {unused} of {there} operations of the vocabulary {name!r}, which no test reaches"


def _never_called(vocabulary: Vocabulary, baseline: Baseline) -> list[str]:
    reached = {place.operation for place in baseline.places}
    return [operation.target for operation in vocabulary.operations if operation.target not in reached]
