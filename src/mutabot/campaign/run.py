"""The campaign: baseline, plan, what still holds, controls, engine; and the journal from the first moment.

How a campaign begins: an executor, the baseline, and the mutants that were asked for.
"""

from __future__ import annotations

import errno
import platform
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from mutabot import __version__, extensions
from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.taking import take_baseline
from mutabot.campaign.baseline.unfit import note_fit, refuse_unfit, refuse_unhooked
from mutabot.campaign.budget import OUT_OF_TIME, run_planned
from mutabot.campaign.campaign import Campaign, OutcomeWriter, on_this_machine
from mutabot.campaign.engines.confirmation import decide, earlier_decision
from mutabot.campaign.engines.rerun import refuse_flaky, rerun
from mutabot.campaign.evidence import Evidence, recorded, without_recording
from mutabot.campaign.faults.demanded import split_ladders
from mutabot.campaign.faults.providers import family_of, prepare
from mutabot.campaign.plan import Plan, carry, draw, drawing, make_plan, note_outdated, reaching, summaries
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.reuse.keys import Dependencies
from mutabot.campaign.reuse.opened import OpenedFiles
from mutabot.campaign.reuse.reuse import Reused, reuse
from mutabot.campaign.reuse.snapshot import Snapshot, State
from mutabot.campaign.selection import refuse_typos, select
from mutabot.campaign.sharding.shards import part_of, write_shard
from mutabot.campaign.since.since import Revision, altered_since, only_altered, open_others
from mutabot.errors import JournalError, NothingToDoError
from mutabot.execution.interruption import interruptions_kept
from mutabot.execution.processes import provide
from mutabot.execution.task import Executor, Result
from mutabot.journal.journal import Journal
from mutabot.journal.lock import at_work
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import DRAWING, DRAWS, INCOMPLETE, OPERATORS, REACHING, REMARKS
from mutabot.model import LeftOut, Mutant, Outcome
from mutabot.model.codec import to_data

#: remarks that are told where there are no mutants
_REMARKS = 8


def open_executor(request: Request, progress: Progress) -> AbstractContextManager[Executor]:
    """What runs the tasks of a campaign."""
    if request.executor is None:
        return on_this_machine(request, progress.note)
    return request.executor.open(request, progress.note)


@contextmanager
def at_it(request: Request, progress: Progress) -> Iterator[Executor]:
    """The same, while the project is locked and Ctrl-C takes effect where it is safe.

    Raises UsageError if the system allows too few open files.
    """
    provide(request.jobs)
    with (
        interruptions_kept(),
        at_work(request.journal_path.parent),
        open_executor(request, progress) as opened,
    ):
        yield opened


def begin(
    request: Request, executor: Executor, progress: Progress, evidence: Evidence | None = None
) -> tuple[Campaign, list[Result]]:
    """Take the baseline. Returns the campaign and the raw results of the baseline.

    Raises what ``take_baseline`` raises, ConfigurationError for orientations that the original lacks and for
    names on a middleware where none is installed, and SelectionError for words of ``--only`` and ``--skip``
    that cannot mean anything.
    """
    refuse_typos(request)
    refuse_unhooked(request.vocabulary)
    baseline, results = take_baseline(request, executor, progress, prepared=prepare(request.project))
    refuse_unfit(baseline, request.vocabulary)
    note_fit(baseline, request.vocabulary, progress)
    return Campaign(request, baseline, executor, progress, evidence), results


def plan_of(request: Request, baseline: Baseline) -> Plan:
    """All mutants that a request may be about."""
    return make_plan(baseline, request.project)


def selected(campaign: Campaign, plan: Plan) -> Plan:
    """The plan with the mutants that were asked for.

    Raises NothingToDoError if none is left, saying why.
    """
    request = campaign.request
    if not plan.mutants:
        raise NothingToDoError(_why_no_mutants(request, plan, campaign.baseline))
    mutants = select(plan.mutants, request.only, request.skip, request.selection, left_out=plan.left_out)
    if not mutants:
        raise NothingToDoError("the selection leaves no mutant to run")
    if request.sample is None:
        return Plan(mutants, plan.left_out)
    drawn, drawing = draw(mutants, request.seed, request.sample)
    return Plan(drawn, plan.left_out, drawing)


def _why_no_mutants(request: Request, plan: Plan, baseline: Baseline) -> str:
    reasons = Counter(one.reason for one in baseline.faults.left_out_beforehand)
    if reasons:
        reason, count = reasons.most_common(1)[0]
        return f"no mutants: all {len(plan.left_out)} are left out, {count} of them because {reason}"
    if not baseline.hits:
        files = ", ".join((*request.configuration.program, *request.configuration.oracle))
        lines = [f"no mutants: no test reaches a call of the vocabulary's operations in {files}"]
        shown = [str(remark) for remark in baseline.remarks[:_REMARKS]]
        more = len(baseline.remarks) - len(shown)
        return "\n".join([*lines, *shown, *([f"… and {more} more"] if more > 0 else [])])
    return f"no mutants: all {len(plan.left_out)} would change nothing"


#: rows that could not be stored, as far as they are told one by one
_UNSTORED = 5
#: what else decides how a campaign ends, beside the user's own files
_VERSIONS = ("pytest", "wrapt", "pytest-bdd")


def run_campaign(request: Request, progress: Progress) -> Path:
    """Run a whole campaign and return the path of its journal.

    Outcomes of earlier campaigns that still hold are taken over. New ones are in the journal within
    a second; an interrupted campaign leaves what it has.

    Raises ConfigurationError, BaselineError, NothingToDoError, ControlError, JournalError.
    """
    started = request.clock()
    with (
        interruptions_kept(),
        Journal.prepare(request.journal_path, meta=_meta(request)) as journal,
    ):
        try:
            with (
                _disk_told(request),
                at_it(request, progress) as opened,
                recorded(request, progress) as evidence,
                ExitStack() as stack,
            ):
                others = [stack.enter_context(one) for one in open_others(request, progress)]
                try:
                    end = _run(request, opened, progress, journal, others, evidence)
                finally:
                    _remember(journal, opened)
            journal.set_meta("seconds", request.clock() - started)
            journal.finish(end)
        except BaseException as error:
            with suppress(JournalError):  # on a full disk not even this can be written
                journal.finish(_reason(error))
            raise
        finally:
            _note_others(journal, progress)
    return request.journal_path


def _run(
    request: Request,
    opened: Executor,
    progress: Progress,
    journal: Journal,
    others: Sequence[JournalReader],
    evidence: Evidence | None,
) -> str:
    """Returns how it ended: a budget may end before all was run."""
    started = request.clock()
    revision = Revision.find(request.root, request.since) if request.since is not None else None
    before = Snapshot.take(request.root)
    with OpenedFiles(request.root, before.folders) as watch:
        campaign, results = begin(request, opened, progress, evidence)
    _note_lacking(request, watch.opened, progress)
    baseline, decided = campaign.baseline, earlier_decision(journal)
    whole = plan_of(request, baseline)
    plan = selected(campaign, whole)
    part = part_of(plan, request.shard, baseline)
    _write_beginning(journal, request, results, plan, whole, progress)
    write_shard(journal, request.shard, part)
    if request.fresh:
        journal.forget(mutant.id for mutant in part.mutants)
    if evidence is not None:
        evidence.begin([(*one.task.key, one.ends) for one in results], whole.mutants)
    journal.set_meta(OPERATORS, summaries(plan.mutants))
    journal.set_meta(DRAWS, drawing(plan.mutants))
    journal.set_meta(REACHING, to_data(reaching(baseline, plan.mutants)))
    if request.shard is not None:
        progress.note(f"{request.shard.words}: {len(part.mutants)} of {len(plan.mutants)} mutants")
    _note_unstable(baseline, progress)
    refuse_flaky(request, baseline)
    campaign = decide(campaign, plan.mutants, journal, decided)
    after = Snapshot.take(request.root, before)
    edited = after.edited_programs(before)
    if edited:
        progress.note(f"{_listed(edited)} changed during the baseline: no outcome is reused, now or later")
        is_whole = _run_all(campaign, part, OutcomeWriter(journal), Reused(), started)
        return _end(journal, part, request, progress, is_whole=is_whole)
    state = State.now(request, before, after, watch.opened)
    dependencies = Dependencies(request, baseline, _collected(results), state)
    journal.add_texts({state.files[name]: text for name, text in state.texts.items()})
    write_shard(journal, request.shard, part, dependencies)
    note_outdated(journal, request, dependencies)
    found = reuse(journal, dependencies, part.mutants, request.rounds, progress, others)
    if revision is not None:
        altered = altered_since(revision, campaign, _collected(results), dependencies, part.mutants)
        part = only_altered(journal, revision, altered, found, part, request.rounds, progress)
    writer = OutcomeWriter(journal, _key_of(journal, dependencies, plan))
    try:
        is_whole = _run_all(campaign, part, writer, found, started)
    finally:
        _forget_if_edited(request, journal, progress, dependencies, after)
    _tidy(request, journal, whole)
    return _end(journal, part, request, progress, is_whole=is_whole)


def _end(journal: Journal, part: Plan, request: Request, progress: Progress, *, is_whole: bool) -> str:
    """How the campaign has ended, by what is in the journal. What could not be stored is told."""
    known = journal.rounds_known()
    for text in journal.unstored[:_UNSTORED]:
        progress.note(f"the journal cannot hold this row: {text}")
    if len(journal.unstored) > _UNSTORED:
        progress.note(f"nor can it hold {len(journal.unstored) - _UNSTORED} more rows")
    if not is_whole:
        return OUT_OF_TIME
    alone, _ = split_ladders(part.mutants)  # of ladders, not every mutant is run
    is_known = all(known.get(mutant.id, 0) >= request.rounds for mutant in alone)
    return "complete" if is_known and not journal.unstored else INCOMPLETE


def _note_others(journal: Journal, progress: Progress) -> None:
    """Say what others did to the journal while the campaign ran."""
    if journal.lost:
        times = f", {len(journal.lost)} times" if len(journal.lost) > 1 else ""
        progress.note(
            f"the journal {journal.lost[0]} while the campaign ran{times}: it was written again, nothing is "
            "lost. Does a test, or a mutant of the program, delete or replace files in .mutabot?"
        )
    for line in journal.altered:
        progress.note(f"the journal was changed by something else and was restored: {line}")


def _remember(journal: Journal, opened: Executor) -> None:
    """Write down what readers are to know of where tasks ran."""
    if opened.remarks:
        with suppress(JournalError):
            journal.set_meta(REMARKS, list(opened.remarks))


def _run_all(campaign: Campaign, plan: Plan, writer: OutcomeWriter, found: Reused, started: float) -> bool:
    """Run all that is not known, as far as there is time for it. Returns whether that is all."""
    is_whole = run_planned(campaign, plan.mutants, writer, found, started)
    if is_whole:
        rerun(campaign.whole, plan.mutants, writer, campaign.request.clock() - started)
    return is_whole


def _tidy(request: Request, journal: Journal, whole: Plan) -> None:
    """Forget mutants that the program has no longer; of other families nothing is known now."""
    there = {mutant.id for mutant, _ in journal.known()} | {mutant.id for mutant in whole.mutants}
    rest = {mutant for mutant, _ in journal.kept()} - there
    journal.tidy([*there, *(one for one in rest if family_of(one) not in request.families)])


def _collected(results: Sequence[Result]) -> set[str]:
    """All tests that the baseline knows of, also those it set aside."""
    ends = (result.end for result in results)
    return {test for end in ends if end is not None for test in end.collected}


def _key_of(journal: Journal, dependencies: Dependencies, plan: Plan) -> Callable[[Outcome], str]:
    by_id = {mutant.id: mutant for mutant in plan.mutants}

    def key_of(outcome: Outcome) -> str:
        key = dependencies.key_of(outcome, by_id[outcome.mutant])
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
            f"{error.filename or home} cannot be written: {error.strerror}; what was written before is kept"
        )
        raise JournalError(text, path=str(request.journal_path)) from error


def plan_only(request: Request, progress: Progress) -> tuple[list[Mutant], list[LeftOut]]:
    """Baseline and plan, without running a mutant."""
    with at_it(request, progress) as opened:
        campaign, _ = begin(request, opened, progress)
    plan = selected(campaign, plan_of(request, campaign.baseline))
    return part_of(plan, request.shard, campaign.baseline).mutants, plan.left_out


def _write_beginning(
    journal: Journal,
    request: Request,
    results: Sequence[Result],
    plan: Plan,
    whole: Plan,
    progress: Progress,
) -> None:
    """From here on the journal is that of this campaign."""
    journal.begin(_meta(request))
    if journal.moved is not None:
        progress.note(
            "the journal of before was damaged or written by another version of mutabot: it is kept as "
            f"{journal.moved.name}, and every mutant is run again"
        )
    if journal.set_aside:
        count = len(journal.set_aside)
        progress.note(
            f"{count} {'row' if count == 1 else 'rows'} in the journal, such as {journal.set_aside[0]}, "
            "mutabot had not written, or they were damaged: nothing of them is reused"
        )
    for result in results:
        round, repetition = result.task.key
        for end in result.ends:
            journal.add_test(round, repetition, without_recording(end))
    known = [mutant for mutant, _ in journal.known()]
    carried = carry(known, request, plan.mutants, whole.mutants)
    paths = {file: request.root / file for file in {m.site.span.file for m in (*plan.mutants, *carried)}}
    sources = {
        file: path.read_text(encoding="utf-8", errors="replace")
        for file, path in paths.items()
        if path.is_file()
    }
    journal.set_plan(plan.mutants, plan.left_out, sources=sources)
    journal.set_known((mutant, True) for mutant in carried)
    if plan.drawing is not None:
        journal.set_meta(DRAWING, to_data(plan.drawing))


def _note_lacking(request: Request, opened: Collection[str] | None, progress: Progress) -> None:
    """Name what tests need and will not have where they run, before anything goes there."""
    preview = request.executor.preview(request.configuration) if request.executor is not None else None
    missed = preview.lacking(opened) if preview is not None else None
    if missed is not None:
        progress.note(missed)


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
        "engine": request.engines[0],
        "jobs": request.jobs,
        "families": list(request.families),
        "every_test": request.every_test,
        "fresh": request.fresh,
        "started": time.time(),
        "vocabulary": to_data(request.vocabulary),
    }


def _versions() -> dict[str, str]:
    found = {}
    for name in (*_VERSIONS, *extensions.versions()):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found
