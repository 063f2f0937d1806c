"""Run a campaign: baseline, plan, reuse, controls, mutants. The journal is written from the start."""

from __future__ import annotations

import errno
import platform
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mutabot import __version__, extensions
from mutabot.campaign.confirmation import earlier_decision, leave_tests_out
from mutabot.campaign.engines.rerun import refuse_flaky, rerun
from mutabot.campaign.evidence import CampaignEvidence, recorded
from mutabot.campaign.faults.providers import family_of
from mutabot.campaign.plan import Plan, carry_over, drawing, reaching, summaries
from mutabot.campaign.preparation import begin, locked_executor, selected, whole_plan
from mutabot.campaign.reuse.keys import Dependencies, OutcomeWriter
from mutabot.campaign.reuse.original import OriginalRuns
from mutabot.campaign.reuse.snapshot import Snapshot, State, is_source
from mutabot.campaign.schedule import OUT_OF_TIME, run_planned
from mutabot.campaign.sharding.shards import part_of, write_shard
from mutabot.campaign.suppressions import note_accepted, source_text
from mutabot.errors import ControlError, JournalError, MutabotError, in_short
from mutabot.execution.interruption import interruptions_kept
from mutabot.execution.versions import name_and_version
from mutabot.journal import records
from mutabot.journal.journal import Journal

from .reuse.reuse import Reused, Revision, altered_since, note_outdated, only_altered, open_others, reuse

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign
    from mutabot.campaign.request import Progress, Request
    from mutabot.execution.task import Executor, Result
    from mutabot.journal.reader import JournalReader

#: what else decides how a campaign ends, beside the user's own files
_VERSIONS = ("pytest", "wrapt", "pytest-bdd")


def run_campaign(request: Request, progress: Progress) -> Path:
    """Run a whole campaign and return the path of its journal.

    Outcomes of earlier campaigns that still hold are taken over. New ones are in the journal within
    a second; an interrupted campaign leaves what it has.

    Raises ConfigurationError, BaselineError, NothingToDoError, ControlError, JournalError.
    """
    started = request.clock()
    with interruptions_kept(), Journal.prepare(request.journal_path, meta=_meta(request)) as journal:
        try:
            with (
                _disk_errors_named(request),
                locked_executor(request, progress) as opened,
                recorded(request, progress) as evidence,
                ExitStack() as stack,
            ):
                others = [stack.enter_context(other) for other in open_others(request, progress)]
                try:
                    end = _run(request, opened, progress, journal, others, evidence, stack)
                finally:
                    if opened.remarks:
                        with suppress(JournalError):
                            journal.set_meta(records.REMARKS, list(opened.remarks))
            journal.set_meta("seconds", request.clock() - started)
            journal.finish(end)
        except BaseException as error:
            is_stopped = isinstance(error, KeyboardInterrupt)
            with suppress(JournalError):  # on a full disk not even this can be written
                why = str(error) if isinstance(error, MutabotError) else f"{type(error).__name__}: {error}"
                journal.finish("interrupted" if is_stopped else why)
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
    evidence: CampaignEvidence | None,
    stack: ExitStack,
) -> str:
    """Run a campaign with its files open. Return how it ended: a budget may end it early."""
    started = request.clock()
    revision = Revision.find(request.root, request.since) if request.since is not None else None
    with OriginalRuns(request, journal.original(), progress) as original:
        campaign, results = begin(request, opened, progress, evidence, original=original, stack=stack)
    request, before, after = campaign.request, original.before, original.after
    _note_lacking(request, original, progress)
    baseline, decided = campaign.baseline, earlier_decision(journal)
    whole, unmatched = whole_plan(campaign)
    plan = selected(campaign, whole)
    part = part_of(plan, request.shard, baseline)
    _write_beginning(campaign, journal, results, plan, whole)
    note_accepted(journal, campaign.suppressions, unmatched)
    write_shard(journal, request.shard, part)
    if request.shard is not None:
        progress.note(f"{request.shard.text}: {len(part.mutants)} of {len(plan.mutants)} mutants")
    if request.fresh:
        journal.forget(mutant.id for mutant in part.mutants)
    if evidence is not None:
        evidence.begin([(*result.task.key, result.ends) for result in results], whole.mutants)
    for (round, test), reason in baseline.unstable.items():
        progress.note(f"excluded in round {round + 1}: {test} ({reason})")
    refuse_flaky(request, baseline)
    campaign = leave_tests_out(campaign, plan.mutants, journal, decided)
    original.keep(journal.set_original)
    edited = [name for name in after.edited_since(before.digests) if is_source(name, request)]
    dependencies, found = None, Reused()
    if edited:
        progress.note(f"{in_short(edited)} changed during the baseline: no outcome is reused, now or later")
    else:
        state = State.now(request, before, after, original.opened)
        dependencies = Dependencies(request, baseline, state, original.installed)
        journal.add_texts({state.files[name]: text for name, text in state.texts.items()})
        write_shard(journal, request.shard, part, dependencies)
        note_outdated(journal, request, dependencies)
        found = reuse(journal, dependencies, part.mutants, request.rounds, progress, others)
        if revision is not None:
            altered = altered_since(revision, campaign, dependencies, found, part.mutants)
            part = only_altered(journal, revision, altered, found, part, request.rounds, progress)
    writer = OutcomeWriter(journal, dependencies, plan.mutants, progress.mutant_ended)
    try:
        with _refutable(campaign, journal):
            is_whole = run_planned(campaign, part.mutants, writer, found, started)
            if is_whole:
                rerun(campaign.whole, part.mutants, writer, request.clock() - started)
    finally:
        if dependencies is not None:
            _forget_if_edited(campaign, journal, dependencies, after)
    if dependencies is not None:
        _tidy(journal, request, whole)
    return _end(journal, part, request.rounds) if is_whole else OUT_OF_TIME


@contextmanager
def _refutable(campaign: Campaign, journal: Journal) -> Iterator[None]:
    """Discard the kept baseline if the original ends differently in a later run."""
    baseline = campaign.baseline
    unstable, is_refuted = len(baseline.unstable), False
    try:
        yield
    except ControlError:
        is_refuted = True
        raise
    finally:
        if is_refuted or len(baseline.unstable) > unstable:
            with suppress(JournalError):
                journal.forget_original()
            campaign.progress.note(
                "the original ended otherwise than in the baseline: the next run takes a new one"
            )


def _note_lacking(request: Request, original: OriginalRuns, progress: Progress) -> None:
    """Note which needed files will be missing where tests run, before anything is sent there."""
    preview = request.executor.preview(request) if request.executor is not None else None
    lacking = preview.lacking(original.opened) if preview is not None else None
    if lacking is not None:
        progress.note(lacking)


def _tidy(journal: Journal, request: Request, whole: Plan) -> None:
    """Forget mutants that the program no longer has; families that were not planned are kept."""
    there = {mutant.id for mutant, _ in journal.known()} | {mutant.id for mutant in whole.mutants}
    rest = {mutant for mutant, _ in journal.kept()} - there
    journal.tidy([*there, *(mutant for mutant in rest if family_of(mutant) not in request.families)])


def _end(journal: Journal, part: Plan, rounds: int) -> str:
    """Return how a campaign that ran everything has ended, by its journal; ladders may skip mutants."""
    known = journal.rounds_known()
    is_known = all(known.get(mutant.id, 0) >= rounds for mutant in part.mutants if not mutant.ladder)
    return "complete" if is_known else records.INCOMPLETE


def _note_others(journal: Journal, progress: Progress) -> None:
    """Note what other processes did to the journal during the campaign."""
    if journal.lost:
        times = f", {len(journal.lost)} times" if len(journal.lost) > 1 else ""
        progress.note(
            f"the journal {journal.lost[0]} while the campaign ran{times}: it was written again, nothing is "
            "lost. Does a test, or a mutant of the program, delete or replace files in .mutabot?"
        )
    for line in journal.altered:
        progress.note(f"the journal was changed by something else and was restored: {line}")


def _forget_if_edited(
    campaign: Campaign, journal: Journal, dependencies: Dependencies, after: Snapshot
) -> None:
    """Mark outcomes as not reusable if files were edited during the campaign."""
    edited = Snapshot.take(campaign.request.root, after).edited_since(dependencies.files)
    if edited:
        campaign.progress.note(
            f"{in_short(edited)} changed while mutants ran: what was found will not be reused"
        )
        with suppress(JournalError):
            journal.forget_keys()


@contextmanager
def _disk_errors_named(request: Request) -> Iterator[None]:
    """Turn errors of writing to disk into errors for users, with the file's name."""
    try:
        yield
    except OSError as error:
        if error.errno not in {errno.ENOSPC, errno.EDQUOT, errno.EROFS}:
            raise
        where = error.filename or request.journal_path.parent
        text = f"{where} cannot be written: {error.strerror}; what was written before is kept"
        raise JournalError(text) from error


def _write_beginning(
    campaign: Campaign, journal: Journal, results: Sequence[Result], plan: Plan, whole: Plan
) -> None:
    """Replace the journal's earlier campaign by this one."""
    request, note = campaign.request, campaign.progress.note
    journal.begin(_meta(request))
    if journal.moved is not None:
        note(
            "the journal of before was damaged or written by another version of mutabot: it is kept as "
            f"{journal.moved.name}, and every mutant is run again"
        )
    if journal.set_aside:
        count = len(journal.set_aside)
        note(
            f"{count} {'row' if count == 1 else 'rows'} in the journal, such as {journal.set_aside[0]}, "
            "mutabot had not written, or they were damaged: nothing of them is reused"
        )
    for result in results:
        round, repetition = result.task.key
        journal.add_tests(records.BaselineTest.of(round, repetition, end) for end in result.ends)
    carried = carry_over([mutant for mutant, _ in journal.known()], request, plan.mutants, whole.mutants)
    files = {span.file for mutant in (*plan.mutants, *carried) for span in mutant.site.spans}
    sources = {file: source_text(path) for file in files if (path := request.root / file).is_file()}
    journal.set_plan(plan.mutants, plan.left_out, sources=sources)
    journal.set_known((mutant, True) for mutant in carried)
    if plan.drawing is not None:
        journal.set_meta(records.DRAWING, plan.drawing)
    if request.only or request.skip:
        count = sum(not mutant.has_sizes for mutant in whole.mutants)
        journal.set_meta(records.SELECTED_OF, count)
    journal.set_meta(records.SIMULATION, request.simulation)
    journal.set_meta(records.RAN_OVER, request.ran_over)
    journal.set_meta(records.OPERATORS, summaries(plan.mutants))
    journal.set_meta(records.DRAWS, drawing(plan.mutants))
    journal.set_meta(records.UNTESTED, campaign.baseline.untested)
    journal.set_meta(records.REACHING, reaching(campaign.baseline, plan.mutants))


def _meta(request: Request) -> dict[str, Any]:
    versions = {}
    for name in (*_VERSIONS, *extensions.versions()):
        with suppress(PackageNotFoundError):
            _, versions[name] = name_and_version(distribution(name))
    return {
        "mutabot": __version__,
        "python": platform.python_version(),
        "versions": versions,
        "root": str(request.root),
        "seed": request.seed,
        "rounds": request.rounds,
        "engine": request.engines[0],
        "jobs": request.jobs,
        "families": list(request.families),
        "every_test": request.every_test,
        "fresh": request.fresh,
        "started": time.time(),
        "vocabulary": request.vocabulary,
    }
