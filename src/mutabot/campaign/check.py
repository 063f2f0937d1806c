"""Check a set-up: run all that comes before the first mutant, and report what is found."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import ExitStack

from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.engine import Unhandled, try_controls
from mutabot.campaign.plan import Plan, make_plan
from mutabot.campaign.request import CheckReport, ExecutorChoice, Preview, Progress, Request
from mutabot.campaign.reuse.snapshot import OpenedFiles
from mutabot.campaign.run import at_it, begin, selected
from mutabot.config.configuration import Configuration
from mutabot.errors import in_short
from mutabot.extensions import brought
from mutabot.journal.files import refuse_tracked
from mutabot.model import Mutant, Vocabulary
from mutabot.model.codec import to_data

#: operations that are named of those that no test reaches
_SHOWN = 5


def check(request: Request, progress: Progress) -> CheckReport:
    """Try the whole set-up, controls included, without running mutants."""
    refuse_tracked(request.journal_path)
    previews = dict(_previews(request.configuration))
    with at_it(request, progress) as opened, ExitStack() as stack:
        folders = {folder for one in previews.values() for folder in one.folders_left_out}
        with OpenedFiles(request.root, folders) as watch:
            campaign, _ = begin(request, opened, progress, stack=stack)
        plan = make_plan(campaign.baseline, request.project)
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
    request, baseline, left_out = campaign.request, campaign.baseline, len(plan.left_out)
    tests = sorted({test for round in range(request.rounds) for test in baseline.ran(round)})
    skipped = f", {baseline.skipped} skipped" if baseline.skipped else ""
    selected = f" selected of {len(plan.mutants)}" if len(mutants) != len(plan.mutants) else ""
    why = "cannot matter" if baseline.faults.left_out_beforehand else "would change nothing"
    reached = {place.operation for place in baseline.hits}
    unused = [one.target for one in request.vocabulary.operations if one.target not in reached]
    flaky, nondeterministic = baseline.unstable, sorted(baseline.nondeterministic)
    clock = request.vocabulary.clock
    never_ticks = clock is not None and all(end.simulated is None for end in baseline.ends.values())
    passing = f"{len(tests)} {'passes' if len(tests) == 1 else 'pass'}"
    rounds = f"{request.rounds} round{'s' if request.rounds != 1 else ''}"
    lines = [
        f"tests     {passing} in {rounds}{skipped}",
        f"sites     {len({place.site for place in baseline.hits})} reached",
        f"controls  {controls} passed",
        f"mutants   {len(mutants)}{selected}, {left_out} left out because they {why}",
        *(f"flaky     {test} in round {round + 1}: {why}" for (round, test), why in flaky.items()),
        *(
            f"nondeterministic  {test} in round {round + 1}: equal runs differ in values"
            for round, test in nondeterministic
        ),
        *_unused(request.vocabulary, unused),
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
        "left_out": left_out,
        "controls": controls,
        "unstable": [{"round": r, "test": t, "reason": why} for (r, t), why in flaky.items()],
        "nondeterministic": [{"round": r, "test": t} for r, t in nondeterministic],
        "unused": unused,
        "remarks": [to_data(remark) for remark in baseline.remarks],
    }
    return CheckReport(lines, data)


def _unused(vocabulary: Vocabulary, unused: Collection[str]) -> Iterator[str]:
    """Name the operations that no test reaches; of a vocabulary's file that has many, the first of them."""
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
