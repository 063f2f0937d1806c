"""``mutabot motion``: one test of a mutant beside that of the original, as it was recorded, or filmed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer

from mutabot.analysis.results import find_mutant, read_results
from mutabot.analysis.stored.evidence import StoredEvidence
from mutabot.campaign.again import anew
from mutabot.campaign.request import Progress, Request
from mutabot.cli import options
from mutabot.cli.output import progress_shown, tell
from mutabot.cli.request import request_again
from mutabot.cli.results import number_of
from mutabot.errors import UsageError
from mutabot.journal.files import find_journal
from mutabot.journal.reader import JournalReader
from mutabot.model import Mutant

from .choice import choose, missing_in
from .filming import choose_graphics, film
from .shown import Shown
from .sights import module, sights_of

Test = Annotated[
    str | None,
    typer.Option("--test", metavar="TEST", help="Show this test: its node id, or a part that is unique."),
]
Video = Annotated[
    Path | None,
    typer.Option("--video", metavar="FILE", help="Film original and mutant beside each other: FILE.mp4."),
]
View = Annotated[bool, typer.Option("--view", help="Show what was recorded in MuJoCo's viewer.")]
Rerun = Annotated[bool, typer.Option("--rerun", help="Show what was recorded in the viewer of Rerun.")]
Rrd = Annotated[
    Path | None, typer.Option("--rrd", metavar="FILE", help="Write what was recorded for Rerun: FILE.rrd.")
]
Mcap = Annotated[
    Path | None,
    typer.Option("--mcap", metavar="FILE", help="Write what was recorded for Foxglove: FILE.mcap."),
]


def motion(
    context: typer.Context,
    mutant: options.OneMutant,
    *,
    round: options.Round = None,
    test: Test = None,
    video: Video = None,
    view: View = False,
    rerun: Rerun = False,
    rrd: Rrd = None,
    mcap: Mcap = None,
    jobs: options.Jobs = None,
) -> None:
    """Show what one mutant of the last campaign did in one test, beside the original.

    It is the test and the round that tell most, if --test and --round do not say which. --video runs both and
    films them. The others run nothing: they show the test as the campaign recorded it.
    """
    path = find_journal(context.obj)
    sights = list(sights_of(path.parent, view=view, rerun=rerun, rrd=rrd, mcap=mcap))
    if video is not None:
        module("pictures.video").check_video(video)
    elif not sights:
        raise UsageError("say how to show it: --video, --view, --rerun, --rrd or --mcap")
    with JournalReader.open(path) as journal, StoredEvidence(path) as evidence:
        results = read_results(journal, earlier=True)
        result = find_mutant(results, mutant)
        wanted = None if round is None else number_of(round, results.rounds)
        shown = choose(results, result, evidence, wanted, test)
    if sights:
        lines = chain(missing_in(shown), (sight.show(shown) for sight in sights))
        tell(f"mutabot: {line}" for line in lines)
    if video is not None:
        request = request_again(path.parent.parent, results, jobs)
        with progress_shown() as progress:
            said = list(_film(request, result.mutant, shown, video, progress))
        tell(f"mutabot: {line}" for line in said)


def _film(request: Request, mutant: Mutant, shown: Shown, file: Path, progress: Progress) -> Iterator[str]:
    """Film the test and the round that are shown. Returns what is to be said about it."""
    with TemporaryDirectory(prefix="mutabot-film-") as folder:
        with anew(request, mutant, shown.round, progress) as (campaign, now):
            choose_graphics()  # for what is filmed alone
            original, other = film(campaign, now, shown.round, shown.test, Path(folder))
        shown = replace(
            shown,
            # of a process that died, what the campaign has recorded is there still
            original=original.recording or shown.original,
            mutant=other.recording or shown.mutant,
            ended=(original.ended, other.ended),
        )
        problems = dict.fromkeys([*original.problems, *other.problems])
        progress.stage("video")
        video = module("pictures.video")
        yield from video.show(file, shown, (original.film, other.film), list(problems))
