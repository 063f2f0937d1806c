"""The beginning of a campaign: its baseline and its plan. ``check`` and ``list`` end there."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.campaign import simulation
from mutabot.campaign.baseline.suite_runs import take_baseline
from mutabot.campaign.baseline.vocabulary_fit import note_fit, refuse_unfit, refuse_unhooked
from mutabot.campaign.baseline.wrappers import shared_sites
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.duration import Duration, duration_of
from mutabot.campaign.engines.engine import try_controls
from mutabot.campaign.faults.providers import family_of, rules_of, texts_of
from mutabot.campaign.plan import Plan, draw, make_plan, of_common
from mutabot.campaign.request import CheckReport, ExecutorChoice, Preview, Progress, Request
from mutabot.campaign.reuse.original import OriginalRuns
from mutabot.campaign.reuse.snapshot import OpenedFiles
from mutabot.campaign.sharding.shards import part_of
from mutabot.campaign.suppressions import divided, suppressions_of
from mutabot.campaign.typos import refuse_typos
from mutabot.config.options import COMMON
from mutabot.errors import JournalError, NothingToDoError, in_short
from mutabot.execution.interruption import interruptions_kept
from mutabot.execution.processes import provide
from mutabot.extensions import brought
from mutabot.frozen import frozen
from mutabot.journal.files import at_work, refuse_tracked
from mutabot.journal.journal import Journal
from mutabot.journal.reader import kept_original
from mutabot.languages.registry import program_files
from mutabot.model.codec import to_data
from mutabot.model.events import Remark
from mutabot.model.left_out import by_heading
from mutabot.model.mutant import Place
from mutabot.model.selection import select
from mutabot.thresholds.planned import split_ladders

if TYPE_CHECKING:
    from mutabot.campaign.baseline.baseline import Baseline
    from mutabot.campaign.engines.forks import Unhandled
    from mutabot.campaign.evidence import CampaignEvidence
    from mutabot.execution.task import Executor, Result
    from mutabot.journal.records import Untested
    from mutabot.model import LeftOut, Mutant, Vocabulary

#: operations that are named of those that no test reaches
_SHOWN = 5
#: remarks that are told where there are no mutants
_REMARKS = 8


def open_executor(request: Request, progress: Progress) -> AbstractContextManager[Executor]:
    """Return a context manager that opens the executor of a campaign."""
    if request.executor is None:
        return request.on_this_machine(progress.note)
    return request.executor.open(request, progress.note)


@contextmanager
def locked_executor(request: Request, progress: Progress) -> Iterator[Executor]:
    """Open the executor of a campaign; meanwhile the project is locked, and Ctrl-C waits until safe.

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
    request: Request,
    executor: Executor,
    progress: Progress,
    evidence: CampaignEvidence | None = None,
    *,
    original: OriginalRuns | None = None,
    stack: ExitStack | None = None,
) -> tuple[Campaign, list[Result]]:
    """Take the baseline. Returns the campaign and the raw results of the baseline.

    ``original``: the runs of the original that are known; None for none. ``stack``: until when a simulation
    of the robot's middleware may run tests; None for no simulation.

    Raises what ``take_baseline`` raises, ConfigurationError for what the original lacks of the vocabulary,
    and SelectionError for words of ``--only`` and ``--skip`` that cannot mean anything. A mistake in a
    decision about mutants is a ConfigurationError.
    """
    refuse_typos(request)
    suppressions = suppressions_of(request)
    refuse_unhooked(request.vocabulary)
    texts = texts_of(request.project, progress.note)

    def take(request: Request, executor: Executor, least: int = 0) -> tuple[Campaign, list[Result]]:
        repetitions = max(request.repetitions, least)
        runs = original.runs_by(executor, request) if original is not None else executor
        baseline, results = take_baseline(request, runs, progress, texts=texts, repetitions=repetitions)
        refuse_unfit(baseline, request.vocabulary)
        return Campaign(request, baseline, executor, progress, evidence), results

    tried = None
    if stack is not None:
        tried = simulation.try_original(
            request, lambda other: take(other, stack.enter_context(open_executor(other, progress)))
        )
    is_compared = tried is not None and tried.campaign is not None
    campaign, results = take(request, executor, 2 if is_compared else 0)
    if tried is not None:
        campaign, results = simulation.chosen(campaign, results, tried)
    files = program_files(request.root, request.configuration.program)
    shared = shared_sites(campaign.baseline, request.vocabulary, campaign.sources, files)
    note_fit(campaign.baseline, request.vocabulary, progress, shared)
    return replace(campaign, suppressions=suppressions), results


def whole_plan(campaign: Campaign) -> tuple[Plan, tuple[str, ...]]:
    """Return the plan without excluded mutants, and descriptions of decisions that match no mutant."""
    return divided(campaign, make_plan(campaign.baseline, campaign.request.project))


def selected(campaign: Campaign, plan: Plan) -> Plan:
    """Return the plan with only the mutants that were asked for.

    Raises NothingToDoError if none is left, saying why.
    """
    request = campaign.request
    ignored = tuple(_ignored(request, plan))
    campaign.baseline.add_remarks(ignored)
    for remark in ignored:
        campaign.progress.note(str(remark))
    reached = {place for _, place in campaign.baseline.reaching}
    if not any(Place.of(mutant) in reached for mutant in plan.mutants):
        raise NothingToDoError(_why_no_mutants(request, plan, campaign.baseline))
    mutants = select(plan.mutants, request.only, request.skip, left_out=plan.left_out)
    mutants = of_common(mutants) if request.operators == COMMON else mutants
    if not mutants:
        raise NothingToDoError("the selection leaves no mutant to run")
    if request.sample is None:
        return Plan(mutants, plan.left_out)
    drawn, how = draw(mutants, request.seed, request.sample)
    return Plan(drawn, plan.left_out, how)


def _ignored(request: Request, plan: Plan) -> Iterator[Remark]:
    """Remark on settings of the configuration that have no effect on any provider of faults."""
    configuration, mutants = request.configuration, plan.mutants
    without = {rule.name for rule in rules_of(request.families) if not rule.has_moments}
    others = sorted({mutant.family for mutant in mutants if mutant.operator in without})
    if request.moments != (None,) and others:
        text = f"mutants of {' and '.join(others)} ignore it: only mutants of calls have moments"
        yield Remark(configuration.file or "configuration", "when", text)
    firsts = [ladder[0] for ladder in split_ladders(mutants)[1].values()]
    kinds = {
        mutant.id: request.vocabulary.quantity(mutant.operation, mutant.pattern, mutant.quantity)
        for mutant in firsts
    }
    for demand in configuration.demands:
        known = ((mutant, kinds[mutant.id]) for mutant in firsts)
        if not any(demand.is_about(mutant, of.kind if of is not None else None) for mutant, of in known):
            family = family_of(f":{demand.operator}")
            text = (
                f"no mutant of {demand.operator} is what it speaks of, so it demands nothing; "
                f"`mutabot list --family {family}` names the sites and quantities that there are"
            )
            yield Remark(demand.source or "configuration", "demand", text)


def _why_no_mutants(request: Request, plan: Plan, baseline: Baseline) -> str:
    files = ", ".join((*request.configuration.program, *request.configuration.oracle))
    if any(not mutant.operation for mutant in plan.mutants):
        return f"no test reaches any of the {len(plan.mutants)} mutants of {files}"
    reasons = by_heading(plan.left_out) if not plan.mutants else {}
    if reasons:
        reasons_text = "; ".join(f"{len(those)} {heading}" for heading, those in reasons.items())
        return f"no mutants: all {len(plan.left_out)} are left out: {reasons_text}"
    if baseline.hits and not plan.mutants:
        families = ", ".join(request.families)
        return f"no mutants: no operator of the families asked for ({families}) acts on what is called"
    lines = [f"no mutants: no test reaches a call of the vocabulary's operations in {files}"]
    lines += [str(remark) for remark in baseline.remarks[:_REMARKS]]
    more = len(baseline.remarks) - _REMARKS
    return "\n".join([*lines, *([f"… and {more} more"] if more > 0 else [])])


@frozen
class PlannedCampaign:
    """A campaign that has been planned but not run.

    Attributes:
        mutants: those that would run.
        left_out: those that would not, with the reasons.
        untested: operations and calls that no test reaches.
        duration: how long the run will take.
    """

    mutants: list[Mutant]
    left_out: list[LeftOut]
    untested: Untested
    duration: Duration


def plan_only(request: Request, progress: Progress) -> PlannedCampaign:
    """Take the baseline and plan, without running a mutant."""
    path = request.journal_path
    with locked_executor(request, progress) as opened, ExitStack() as stack:
        with OriginalRuns(request, kept_original(path), progress) as original:
            campaign, _ = begin(request, opened, progress, original=original, stack=stack)
        _leave(original, path)
    plan = selected(campaign, whole_plan(campaign)[0])
    part = part_of(plan, request.shard, campaign.baseline)
    duration = duration_of(campaign, part.mutants)
    return PlannedCampaign(part.mutants, part.left_out, campaign.baseline.untested, duration)


def check(request: Request, progress: Progress) -> CheckReport:
    """Try the whole set-up, controls included, without running other mutants."""
    refuse_tracked(request.journal_path)
    previews = dict(_previews(request))
    with locked_executor(request, progress) as opened, ExitStack() as stack:
        folders = {
            folder for program_preview in previews.values() for folder in program_preview.folders_left_out
        }
        # files that the first reads itself are not opened by tests: it begins before the second
        with OriginalRuns(request, None, progress) as original, OpenedFiles(request.root, folders) as watch:
            campaign, _ = begin(request, opened, progress, original=original, stack=stack)
        plan, _ = whole_plan(campaign)
        mutants = selected(campaign, plan).mutants
        controls, unhandled = try_controls(campaign, mutants)
    _leave(original, request.journal_path)
    report = _report(campaign, plan, mutants, controls, unhandled)
    for name, preview in previews.items():
        lines, data = preview.check(watch.opened)
        report = CheckReport([*report.lines, *lines], {name: data, **report.data})
    return report


def _leave(original: OriginalRuns, journal: Path) -> None:
    """Keep the runs of the original for later campaigns, unless another campaign is running."""
    with suppress(JournalError):
        original.keep(lambda kept: Journal.keep_original(journal, kept))


def _previews(request: Request) -> Iterator[tuple[str, Preview]]:
    """Yield each executor that the configuration has a table for, with what it would take elsewhere."""
    if not request.configuration.tables:
        return
    for name, part in brought("executors").items():
        if name in request.configuration.tables:
            preview = part.load_class(ExecutorChoice).preview(request)  # type: ignore[type-abstract]
            if preview is not None:
                yield name, preview


def _report(
    campaign: Campaign, plan: Plan, mutants: list[Mutant], controls: int, unhandled: Unhandled
) -> CheckReport:
    request, baseline, left_out = campaign.request, campaign.baseline, len(plan.left_out)
    tests = sorted({test for round in range(request.rounds) for test in baseline.ran(round)})
    skipped = f", {baseline.skipped} skipped" if baseline.skipped else ""
    selected = f" selected of {len(plan.mutants)}" if len(mutants) != len(plan.mutants) else ""
    reasons = by_heading(plan.left_out)
    reached = {place.operation for place in baseline.hits}
    unused = [
        operation.target for operation in request.vocabulary.operations if operation.target not in reached
    ]
    flaky, nondeterministic = baseline.unstable, sorted(baseline.nondeterministic)
    clock = request.vocabulary.clock
    never_ticks = clock is not None and all(end.simulated is None for end in baseline.ends.values())
    duration = duration_of(campaign, mutants)
    passing = f"{len(tests)} {'passes' if len(tests) == 1 else 'pass'}"
    rounds = f"{request.rounds} round{'s' if request.rounds != 1 else ''}"
    lines = [
        f"tests     {passing} in {rounds}{skipped}",
        f"sites     {len({place.site for place in baseline.hits})} reached",
        f"controls  {controls} passed",
        f"mutants   {len(mutants)}{selected}",
        f"time      {duration.text}; less where results are reused",
        *(f"left out  {len(those)}: {heading}" for heading, those in reasons.items()),
        *(f"flaky     {test} in round {round + 1}: {why}" for (round, test), why in flaky.items()),
        *(
            f"nondeterministic  {test} in round {round + 1}: equal runs differ in values"
            for round, test in nondeterministic
        ),
        *_unused(request.vocabulary, unused),
        *_untested(baseline.untested),
    ]
    if clock is not None and never_ticks:
        lines.append(f"unused    clock: no test calls {clock.tick}, so there is no simulated time")
    lines += [f"note      {remark}" for remark in (*baseline.remarks, request.ran_over) if remark]
    lines += [f"replay    {test}: {why}" for test, why in unhandled.reasons.items()]
    data = {
        "replay": dict(unhandled.reasons),
        "tests": tests,
        "sites": [place.key for place in baseline.hits],
        "mutants": len(mutants),
        "planned": len(plan.mutants),
        "runs": duration.runs,
        "seconds": duration.seconds,
        "left_out": left_out,
        "left_out_because": {heading: len(those) for heading, those in reasons.items()},
        "controls": controls,
        "unstable": [{"round": r, "test": t, "reason": why} for (r, t), why in flaky.items()],
        "nondeterministic": [{"round": r, "test": t} for r, t in nondeterministic],
        "unused": unused,
        "untested": to_data(baseline.untested),
        "remarks": [to_data(remark) for remark in baseline.remarks],
    }
    return CheckReport(lines, data)


def _untested(found: Untested) -> Iterator[str]:
    """Yield lines about the parts of the program that no test reaches."""
    if found.text:
        yield f"untested  {found.text}"
    for what, names in found.named.items():
        yield f"untested  {what}: {in_short(names, _SHOWN)}"


def _unused(vocabulary: Vocabulary, unused: Collection[str]) -> Iterator[str]:
    """Yield lines about the operations that no test reaches; of a file with many, only the first."""
    of: dict[str, list[str]] = {}
    for operation in vocabulary.operations:
        of.setdefault(operation.source.partition(":")[0], []).append(operation.target)
    for name, there in of.items():
        found = [target for target in there if target in unused]
        if found:
            yield (
                f"unused    {len(found)} of {len(there)} operations of {name}, which no test reaches from "
                f"the program or the oracle: {in_short(found, _SHOWN)}"
            )
