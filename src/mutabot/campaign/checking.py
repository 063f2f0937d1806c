"""What ``check`` and ``list`` say: the plan of a campaign that ends before its mutants run."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.campaign.baseline.remarks import lines_of
from mutabot.campaign.baseline.vocabulary_fit import never_ticks_text
from mutabot.campaign.duration import Duration, duration_of
from mutabot.campaign.engines.engine import try_controls
from mutabot.campaign.request import CheckReport, ExecutorChoice, Preview, Progress, Request
from mutabot.campaign.reuse.original import OriginalRuns
from mutabot.campaign.reuse.snapshot import OpenedFiles
from mutabot.campaign.sharding.shards import part_of
from mutabot.errors import JournalError, in_short
from mutabot.extensions import brought
from mutabot.frozen import frozen
from mutabot.journal.files import refuse_tracked
from mutabot.journal.journal import Journal
from mutabot.journal.reader import kept_original
from mutabot.model.codec import to_data
from mutabot.model.left_out import by_heading

if TYPE_CHECKING:
    from mutabot.campaign.campaign import Campaign
    from mutabot.campaign.engines.forks import Unhandled
    from mutabot.campaign.plan import Plan
    from mutabot.journal.records import Untested
    from mutabot.model import LeftOut, Mutant, Vocabulary
from mutabot.campaign.preparation import begin, locked_executor, selected, whole_plan

#: operations that are named of those that no test reaches
_SHOWN = 5


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


class _HeldNotes(Progress):
    """Progress that holds its notes back until it is known which of them the report contains."""

    def __init__(self, progress: Progress) -> None:
        self._progress, self._notes = progress, dict[str, None]()

    def stage(self, text: str, total: int | None = None) -> None:
        self._progress.stage(text, total)

    def advance(self, line: str | None = None) -> None:
        self._progress.advance(line)

    def note(self, text: str) -> None:
        self._notes[text] = None

    def release(self, reported: str) -> None:
        """Show the notes that are not in a report."""
        for text in self._notes:
            if text not in reported:
                self._progress.note(text)


def check(request: Request, progress: Progress) -> CheckReport:
    """Try the whole set-up, controls included, without running other mutants."""
    notes, reported = _HeldNotes(progress), ""
    try:
        report = _check(request, notes)
        reported = "\n".join(report.lines)
    finally:
        notes.release(reported)
    return report


def _check(request: Request, progress: Progress) -> CheckReport:
    refuse_tracked(request.journal_path)
    previews = dict(_previews(request))
    with locked_executor(request, progress) as opened, ExitStack() as stack:
        folders = {folder for preview in previews.values() for folder in preview.folders_left_out}
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
        lines.append(f"unused    {never_ticks_text(clock)}")
    lines += [f"note      {note}" for note in (*lines_of(baseline.remarks), request.ran_over) if note]
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
