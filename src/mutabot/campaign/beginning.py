"""How a campaign begins: an executor, the baseline, and the mutants that were asked for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.taking import take_baseline
from mutabot.campaign.baseline.unfit import note_ranges, refuse_unfit, refuse_unhooked
from mutabot.campaign.engines.choice import first_engine, repetitions_for
from mutabot.campaign.faults.providers import prepare
from mutabot.campaign.plan.plan import Plan, draw, make_plan
from mutabot.campaign.plan.selection import refuse_typos, select
from mutabot.campaign.workers.descriptors import provide
from mutabot.campaign.workers.interruption import interruptions_kept
from mutabot.campaign.workers.task import Executor, Result
from mutabot.errors import NothingToDoError
from mutabot.journal.files import at_work

from .campaign import Campaign
from .evidence import Evidence
from .local import on_this_machine
from .request import Progress, Request

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
    provide(request.jobs, served=request.pause is not None)
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
    baseline, results = take_baseline(
        request, executor, progress, prepared=prepare(request.project),
        repetitions=repetitions_for(request), may_share=first_engine(request).may_share,
    )  # fmt: skip
    refuse_unfit(baseline, request.vocabulary)
    note_ranges(baseline, request.vocabulary, progress)
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
