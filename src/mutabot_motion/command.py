"""``mutabot motion``: shows a test of a mutant beside that of the original, as recorded or filmed.

Without --round and --test, the round and test with the largest deviation are shown.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer

from mutabot.api.processes import Request
from mutabot.api.reports import (
    CampaignRun,
    CommandContext,
    MutantResult,
    Progress,
    RecordedPaths,
    Results,
    UsageError,
)

from .filming import film
from .view import MotionView
from .viewers import check, module, viewers_of

#: tests that are named where several fit
_LISTED = 5
_WHAT_TO_DO = (
    "`mutabot run --fresh` records it if `evidence` is not 0 and a simulator reports where things are, see "
    "docs/motion.md"
)


def choose(
    context: CommandContext,
    results: Results,
    result: MutantResult,
    round: int | None = None,
    test: str | None = None,
) -> MotionView:
    """Return the test, round and recordings of a mutant to show.

    Args:
        context: of the command.
        results: all that is known of the campaign.
        result: the mutant.
        round: 0-based; None for the one in which the world was worst.
        test: node id or a part of one; None for the one in which it was worst, else for the one that killed.

    Raises UsageError for a test that does not run the mutant, and if none does.
    """
    mutant = result.mutant
    where = round if round is not None else _clearest_round(result)
    outcome = next((candidate for candidate in result.outcomes if candidate.round == where), None)
    named: list[str] = []
    if outcome is not None:
        noticed = *(kill.test for kill in outcome.kills), outcome.test
        named = [
            *(divergence.test for divergence in outcome.diverged),
            *(test_name for test_name in noticed if test_name is not None),
        ]
    with closing(context.recordings()) as recordings:
        kept = recordings.tests(mutant.id, where)
        tests = list(dict.fromkeys([*named, *kept, *_reached_by(results, result)]))
        if not tests:
            raise UsageError(f"no test reaches mutant {mutant.number} ({mutant.id}): there is nothing to see")
        name = tests[0] if test is None else _matching_test(tests, test)
        original, mutated = recordings.pair(mutant.id, where, name)
    diverged = (
        next((divergence for divergence in outcome.diverged if divergence.test == name), None)
        if outcome
        else None
    )
    return MotionView(
        mutant.number,
        mutant.id,
        mutant.description,
        mutant.site.span.place,
        name,
        where,
        RecordedPaths(original) if original is not None else None,
        RecordedPaths(mutated) if mutated is not None else None,
        diverged.story if diverged is not None else "",
        diverged.at if diverged is not None else None,
    )


def missing_in(view: MotionView) -> list[str]:
    """Return what is missing in the recordings, one line each. Raises UsageError if nothing was recorded."""
    which = f"{view.test} in round {view.round + 1}"
    if view.original is None:
        raise UsageError(f"nothing is recorded of {which}: {_WHAT_TO_DO}")
    found = []
    if view.mutant is None and view.story:
        found.append(f"what mutant {view.number} did found no room: set `evidence` to more, and run it again")
    elif view.mutant is None:
        found.append(f"nothing that is recorded of {which} differs: only the original is shown")
    if not view.original.recording.tracks:
        found.append("no simulator reports where things are: only calls are shown, see docs/motion.md")
    return found


def _clearest_round(result: MutantResult) -> int:
    """Return the round that shows the mutant's effect best, from 0; of equal ones the first."""
    ranks = []
    for outcome in result.outcomes:
        difference = outcome.shown_difference
        deviation = outcome.deviation or 0.0 if difference is not None else 0.0
        is_clear = difference is not None and not difference.scatters
        ranks.append((bool(outcome.acted), is_clear, deviation, -outcome.round))
    return -max(ranks)[-1] if ranks else 0


def _reached_by(results: Results, result: MutantResult) -> tuple[str, ...]:
    if not results.reaching.tests:  # an older journal does not say it
        return tuple(dict.fromkeys(baseline_test.test.test for baseline_test in results.baseline))
    return results.reached_by(result.mutant)


def _matching_test(tests: list[str], wanted: str) -> str:
    """Return the test with this node id, or the only one whose id contains it."""
    if wanted in tests:
        return wanted
    found = [test for test in tests if wanted in test]
    if len(found) == 1:
        return found[0]
    listed = ", ".join((found or tests)[:_LISTED]) + (" …" if len(found or tests) > _LISTED else "")
    problem = f"several tests fit: {listed}" if found else f"no such test runs the mutant; these do: {listed}"
    raise UsageError(f"--test {wanted}: {problem}")


TestOption = Annotated[
    str | None,
    typer.Option("--test", metavar="TEST", help="Show this test: its node id, or a part that is unique."),
]
Video = Annotated[
    Path | None,
    typer.Option(
        "--video", metavar="FILE", help="Film original and mutant beside each other: FILE.mp4 or FILE.gif."
    ),
]
Rerun = Annotated[bool, typer.Option("--rerun", help="Show what was recorded in the viewer of Rerun.")]
Rrd = Annotated[
    Path | None, typer.Option("--rrd", metavar="FILE", help="Write what was recorded for Rerun: FILE.rrd.")
]
Mcap = Annotated[
    Path | None,
    typer.Option("--mcap", metavar="FILE", help="Write what was recorded for Foxglove: FILE.mcap."),
]


def motion(
    context: CommandContext,
    mutant: str,
    *,
    round: int | None = None,
    test: TestOption = None,
    video: Video = None,
    rerun: Rerun = False,
    rrd: Rrd = None,
    mcap: Mcap = None,
    jobs: int | None = None,
) -> None:
    """Show what one mutant of the last campaign did in one test, beside the original.

    Without --test and --round, it is the test and the round with the largest deviation. --video runs both and
    films them. The other options run nothing: they show the test as the campaign recorded it.
    """
    viewers = list(viewers_of(context.journal.parent, rerun=rerun, rrd=rrd, mcap=mcap))
    if video is not None:
        module("pictures.video")
        check(video, ".mp4", ".gif")
    elif not viewers:
        raise UsageError("say how to show it: --video, --rerun, --rrd or --mcap")
    results = context.results(earlier=True)
    result = results.mutant(mutant)
    wanted = None if round is None else results.round_index(round)
    view = choose(context, results, result, wanted, test)
    if viewers:
        lines = chain(missing_in(view), (viewer(view) for viewer in viewers))
        context.notify(f"mutabot: {line}" for line in lines)
    if video is not None:
        request = context.request_again(results, jobs)
        with context.progress() as progress:
            remarks = list(_film(request, result, view, video, progress))
        if video.suffix.lower() == ".mp4":
            context.keep_film(results, result.mutant.id, video, view.round, view.test)
            remarks.append("`mutabot report --html` shows it in the mutant's page")
        context.notify(f"mutabot: {line}" for line in remarks)


def _film(
    request: Request, result: MutantResult, view: MotionView, file: Path, progress: Progress
) -> Iterator[str]:
    """Film the test and round that are shown; yield lines on the result."""
    with TemporaryDirectory(prefix="mutabot-film-") as folder:
        with CampaignRun.open(replace(request, rounds=view.round + 1), progress) as campaign:
            original, other = film(campaign, result, view.round, view.test, Path(folder))
        view = replace(
            view,
            # of a process that died, what the campaign has recorded is there still
            original=original.recording or view.original,
            mutant=other.recording or view.mutant,
            ended=(original.ended, other.ended),
        )
        problems = dict.fromkeys([*original.problems, *other.problems])
        video = module("pictures.video")
        yield from video.show(file, view, (original.film, other.film), list(problems), progress)
