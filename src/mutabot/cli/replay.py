"""``mutabot replay``: one mutant of the last campaign once more, or what was recorded of it, to be seen."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415, PLR0917

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from mutabot.errors import UsageError
from mutabot.exit_codes import ExitCode
from mutabot.journal.files import find_journal

from . import options
from .output import print_json, progress_shown, tell
from .request import request_of

if TYPE_CHECKING:
    from mutabot.analysis.results import Results
    from mutabot.campaign.campaign import Campaign
    from mutabot.campaign.filming import Take
    from mutabot.journal.reader import JournalReader
    from mutabot.journal.records import Replayed
    from mutabot.model import Mutant
    from mutabot_motion.shown import Shown

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
_Also = Callable[["Campaign", "Mutant"], object]


def replay(
    context: typer.Context,
    mutant: options.OneMutant,
    round: options.Round = None,
    test: Test = None,
    video: Video = None,
    view: View = False,
    rerun: Rerun = False,
    rrd: Rrd = None,
    mcap: Mcap = None,
    jobs: options.Jobs = None,
    json: options.Json = False,
) -> None:
    """Run one mutant of the last campaign again in fresh processes; exit with 4 if it ends otherwise.

    With --video one test of it is filmed as well, beside the original's. --view, --rerun, --rrd and --mcap
    run nothing: they show one test as the campaign recorded it. It is the test and the round that tell most,
    if --test and --round do not say which.
    """
    from mutabot.analysis.results import find_mutant, read_results
    from mutabot.analysis.stored.evidence import StoredEvidence
    from mutabot.journal.reader import JournalReader
    from mutabot_motion.choice import choose
    from mutabot_motion.pictures.video import check_video
    from mutabot_motion.sights import show_all, sights_of

    path = find_journal(context.obj)
    sights = sights_of(path.parent, view=view, rerun=rerun, rrd=rrd, mcap=mcap)
    if video is not None:
        check_video(video)
    elif test is not None and not sights:
        raise UsageError("--test says what to show: by --video, --view, --rerun, --rrd or --mcap")
    with JournalReader.open(path) as journal, StoredEvidence(path) as evidence:
        found = read_results(journal, earlier=True)
        chosen = find_mutant(found, mutant)
        if round is not None and round > found.rounds:
            raise UsageError(f"there is no round {round}; the campaign has {found.rounds}")
        wanted = None if round is None else round - 1
        if video is None and not sights:
            rounds = range(found.rounds) if wanted is None else [wanted]
            replayed = _run(path, journal, found, chosen.mutant, rounds, jobs)
        else:
            shown = choose(found, chosen, evidence, wanted, test)
            if sights:
                tell(f"mutabot: {line}" for line in show_all(sights, shown))
            if video is None:
                return
            replayed = _film(path, journal, found, chosen.mutant, shown, jobs, video)
    raise typer.Exit(_print(chosen.mutant, replayed, json=json))


def _run(
    path: Path,
    journal: JournalReader,
    found: Results,
    mutant: Mutant,
    rounds: Iterable[int],
    jobs: int | None,
    also: _Also | None = None,
) -> list[Replayed]:
    from mutabot.campaign.again import replay_one

    request = request_of(
        path.parent.parent, rounds=found.rounds, seed=found.meta.get("seed"), jobs=jobs,
        family=found.meta.get("families"), order=found.meta.get("order"),
        every_test=found.meta.get("every_test"),
    )  # fmt: skip
    with progress_shown() as progress:
        return replay_one(request, journal, mutant, rounds, progress, also)


def _film(
    path: Path,
    journal: JournalReader,
    found: Results,
    mutant: Mutant,
    shown: Shown,
    jobs: int | None,
    file: Path,
) -> list[Replayed]:
    """Run it again in the round that is shown, and film the test that is shown."""
    from mutabot.campaign.filming import choose_graphics, film
    from mutabot_motion.pictures.video import show

    takes: list[Take] = []
    with TemporaryDirectory(prefix="mutabot-film-") as folder:

        def also(campaign: Campaign, mutant: Mutant) -> None:
            choose_graphics()  # for these runs alone: the others are as in the campaign
            takes.extend(film(campaign, mutant, shown.round, shown.test, Path(folder)))

        replayed = _run(path, journal, found, mutant, [shown.round], jobs, also)
        original, other = takes
        shown = replace(
            shown,
            # of a process that died, what the campaign has recorded is there still
            original=original.recording or shown.original,
            mutant=other.recording or shown.mutant,
            ended=(original.ended, other.ended),
        )
        problems = dict.fromkeys([*original.problems, *other.problems])
        with progress_shown() as progress:
            progress.stage("video")
            said = show(file, shown, (original.film, other.film), list(problems))
    tell(f"mutabot: {line}" for line in said)
    return replayed


def _print(mutant: Mutant, replayed: list[Replayed], *, json: bool) -> ExitCode:
    from mutabot.report.as_json import replayed_data
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.mutant.detail import print_replayed

    if json:
        print_json(replayed_data(mutant, replayed))
    else:
        print_replayed(make_console(), mutant, replayed)
    return ExitCode.UNRELIABLE if any(one.agrees is False for one in replayed) else ExitCode.FINE
