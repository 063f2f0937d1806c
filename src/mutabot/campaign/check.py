"""Checking a set-up: all that comes before the first mutant, and what is to be said about it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.engine import try_controls
from mutabot.campaign.engines.fork_parent import Unhandled
from mutabot.campaign.plan import Plan
from mutabot.campaign.request import CheckReport, ExecutorChoice, Preview, Progress, Request
from mutabot.campaign.reuse.opened import OpenedFiles
from mutabot.campaign.run import at_it, begin, plan_of, selected
from mutabot.extensions import brought
from mutabot.families import CATALOGUE
from mutabot.journal.lock import refuse_tracked
from mutabot.model import Mutant, Vocabulary
from mutabot.model.codec import to_data
from mutabot.model.operation import MAIN
from mutabot.operators import load_all
from mutabot.settings.configuration import Configuration
from mutabot.vocabulary.load import shipped


def check(request: Request, progress: Progress) -> CheckReport:
    """Try the whole set-up, controls included, without running mutants."""
    refuse_tracked(request.journal_path)
    previews = dict(_previews(request.configuration))
    with at_it(request, progress) as opened:
        folders = {folder for one in previews.values() for folder in one.folders_left_out}
        with OpenedFiles(request.root, folders) as watch:
            campaign, _ = begin(request, opened, progress)
        plan = plan_of(request, campaign.baseline)
        mutants = selected(campaign, plan).mutants
        controls, unhandled = try_controls(campaign, mutants)
    report = _report(campaign, plan, mutants, controls, unhandled)
    for name, preview in previews.items():
        lines, data = preview.check(watch.opened)
        report = CheckReport([*report.lines, *lines], {name: data, **report.data})
    return report


def _previews(configuration: Configuration) -> Iterator[tuple[str, Preview]]:
    """What executors that the configuration has a table for would take elsewhere, by their names."""
    if not configuration.tables:
        return
    for name, part in brought("executors").items():
        if name in configuration.tables:
            preview = part.load_class(ExecutorChoice).preview(configuration)  # type: ignore[type-abstract]
            if preview is not None:
                yield name, preview


def _report(
    campaign: Campaign, plan: Plan, mutants: list[Mutant], controls: int, unhandled: Unhandled
) -> CheckReport:
    request, baseline = campaign.request, campaign.baseline
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
    lines += _unused(request.vocabulary, _worth_telling(request.vocabulary, never, baseline))
    clock = request.vocabulary.clock
    if clock is not None and all(end.simulated is None for end in baseline.ends.values()):
        lines.append(f"unused    clock: no test calls {clock.tick}, so there is no simulated time")
    nowhere = dict(_nowhere(plan, request.families))
    lines += [f"nowhere   {name}: {why}" for name, why in nowhere.items()]
    lines += [f"note      {remark}" for remark in baseline.remarks]
    lines += [f"replay    {test}: {why}" for test, why in unhandled.reasons.items()]
    data = {
        "replay": dict(unhandled.reasons),
        "tests": tests,
        "sites": [place.key for place in baseline.places],
        "mutants": len(mutants),
        "planned": len(plan.mutants),
        "left_out": len(plan.left_out),
        "controls": controls,
        "unstable": [{"round": r, "test": t, "reason": why} for (r, t), why in baseline.unstable.items()],
        "restless": [{"round": r, "test": t} for r, t in sorted(baseline.restless)],
        "unused": never,
        "nowhere": nowhere,
        "remarks": [to_data(remark) for remark in baseline.remarks],
    }
    return CheckReport(lines, data)


def _why_left_out(baseline: Baseline) -> str:
    return "cannot matter" if baseline.faults.left_out_beforehand else "would change nothing"


def _nowhere(plan: Plan, families: Collection[str]) -> Iterator[tuple[str, str]]:
    """Operators of the catalogue of which the plan has no mutant, with the reason."""
    if CATALOGUE not in families:
        return
    made = {mutant.operator for mutant in plan.mutants}
    reasons: dict[str, Counter[str]] = {}
    for item in plan.left_out:
        name = item.id.rpartition(":")[2].partition("=")[0].partition("@")[0]
        reasons.setdefault(name, Counter())[item.reason] += 1
    for rule in load_all():
        if rule.family != CATALOGUE or rule.name in made:
            continue
        if rule.name in reasons:
            yield rule.name, reasons[rule.name].most_common(1)[0][0]
        else:
            yield rule.name, f"nothing here has what it needs: {rule.where}"


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


def _worth_telling(vocabulary: Vocabulary, never: Sequence[str], baseline: Baseline) -> list[str]:
    """Of names on a middleware remarks tell more, and what goes with them goes without saying."""
    told = {(remark.source, remark.key) for remark in baseline.remarks}
    operations = {operation.target: operation for operation in vocabulary.operations}
    found = []
    for target in never:
        operation = operations[target]
        named = operation.named
        if named is None or (named.form in MAIN and (operation.source, named.form) not in told):
            found.append(target)
    return found


def _never_called(vocabulary: Vocabulary, baseline: Baseline) -> list[str]:
    reached = {place.operation for place in baseline.places}
    return [operation.target for operation in vocabulary.operations if operation.target not in reached]
