"""The beginning of a campaign: its baseline and its plan."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from mutabot.campaign import simulation
from mutabot.campaign.baseline.remarks import lines_of
from mutabot.campaign.baseline.suite_runs import take_baseline
from mutabot.campaign.baseline.vocabulary_fit import note_fit, refuse_unfit, refuse_unhooked
from mutabot.campaign.baseline.wrappers import shared_sites
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.faults.providers import family_of, rules_of, texts_of
from mutabot.campaign.plan import Plan, draw, make_plan, of_common
from mutabot.campaign.suppressions import divided, suppressions_of
from mutabot.campaign.typos import refuse_typos
from mutabot.config.options import COMMON
from mutabot.errors import NothingToDoError
from mutabot.execution.interruption import interruptions_kept
from mutabot.execution.processes import provide
from mutabot.journal.files import at_work
from mutabot.languages.registry import program_files
from mutabot.model.events import Remark
from mutabot.model.left_out import by_heading
from mutabot.model.mutant import Place
from mutabot.model.selection import select
from mutabot.thresholds.planned import split_ladders

if TYPE_CHECKING:
    from mutabot.campaign.baseline.baseline import Baseline
    from mutabot.campaign.evidence import CampaignEvidence
    from mutabot.campaign.request import Progress, Request
    from mutabot.campaign.reuse.original import OriginalRuns
    from mutabot.execution.task import Executor, Result

#: remarks that are reported where there are no mutants
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
    remarks = lines_of(baseline.remarks)
    lines += remarks[:_REMARKS]
    more = len(remarks) - _REMARKS
    return "\n".join([*lines, *([f"… and {more} more"] if more > 0 else [])])
