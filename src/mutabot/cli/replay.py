"""``mutabot replay``: one mutant of the last campaign once more."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

import typer

from mutabot.errors import UsageError
from mutabot.exit_codes import ExitCode
from mutabot.journal.files import find_journal

from . import options
from .output import print_json, progress_shown
from .request import request_of


def replay(
    context: typer.Context,
    mutant: options.OneMutant,
    round: options.Round = None,
    jobs: options.Jobs = None,
    json: options.Json = False,
) -> None:
    """Run one mutant of the last campaign again in fresh processes; exit with 4 if it ends otherwise."""
    from mutabot.analysis.results import find_mutant, read_results
    from mutabot.campaign.again import replay_one
    from mutabot.journal.reader import JournalReader
    from mutabot.report.as_json import replayed_data
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.mutant.detail import print_replayed

    path = find_journal(context.obj)
    with JournalReader.open(path) as journal:
        found = read_results(journal, earlier=True)
        chosen = find_mutant(found, mutant).mutant
        if round is not None and round > found.rounds:
            raise UsageError(f"there is no round {round}; the campaign has {found.rounds}")
        rounds = range(found.rounds) if round is None else [round - 1]
        request = request_of(
            path.parent.parent, rounds=found.rounds, seed=found.meta.get("seed"), jobs=jobs,
            family=found.meta.get("families"), order=found.meta.get("order"),
            every_test=found.meta.get("every_test"), no_oracle=found.meta.get("no_oracle"),
        )  # fmt: skip
        with progress_shown() as progress:
            replayed = replay_one(request, journal, chosen, rounds, progress)
    if json:
        print_json(replayed_data(chosen, replayed))
    else:
        print_replayed(make_console(), chosen, replayed)
    raise typer.Exit(ExitCode.UNRELIABLE if any(one.agrees is False for one in replayed) else ExitCode.FINE)
