"""``mutabot results``, ``show`` and ``replay``: what the journal holds. The first two load little."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

import typer

from mutabot.cli import options
from mutabot.cli.output import print_json, progress_shown, show_results
from mutabot.cli.request import request_again
from mutabot.errors import UsageError
from mutabot.exit_codes import ExitCode
from mutabot.journal.files import find_journal


def results(context: typer.Context, all: options.All = False, json: options.Json = False) -> None:
    """Show the results of the last campaign, also of one that was interrupted or still runs."""
    show_results(find_journal(context.obj), json=json, everything=all, earlier=True)


def show(
    context: typer.Context,
    mutant: options.OneMutant,
    json: options.Json = False,
) -> None:
    """Show everything about one mutant."""
    from mutabot.analysis.results import find_mutant, read_results
    from mutabot.analysis.stored import StoredEvidence
    from mutabot.analysis.suggested import kept_suggestions
    from mutabot.journal.reader import JournalReader
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.mutant import print_mutant

    path = find_journal(context.obj)
    with JournalReader.open(path) as journal:
        found = read_results(journal, earlier=True)
        result = find_mutant(found, mutant)
        is_there = not result.outdated or result.mutant.family in found.meta.get("families", ())
        source = journal.source(result.mutant.site.span.file) if is_there else None
    if json:
        from mutabot.report.as_json import result_data

        print_json(result_data(result))
    else:
        with StoredEvidence(path) as evidence:
            suggestions = kept_suggestions(path, found.meta)
            print_mutant(make_console(), result, source, evidence, suggestions)


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
    from mutabot.report.terminal.mutant import print_replayed

    path = find_journal(context.obj)
    with JournalReader.open(path) as journal:
        found = read_results(journal, earlier=True)
        chosen = find_mutant(found, mutant).mutant
        rounds = range(found.rounds) if round is None else [number_of(round, found.rounds)]
        request = request_again(path.parent.parent, found, jobs)
        with progress_shown() as progress:
            replayed = replay_one(request, journal, chosen, rounds, progress)
    if json:
        print_json(replayed_data(chosen, replayed))
    else:
        print_replayed(make_console(), chosen, replayed)
    differs = any(one.agrees is False for one in replayed)
    raise typer.Exit(ExitCode.UNRELIABLE if differs else ExitCode.FINE)


def number_of(round: int, rounds: int) -> int:
    """A round as it is counted inside, from 0 on. Raises UsageError if the campaign has fewer."""
    if round > rounds:
        raise UsageError(f"there is no round {round}; the campaign has {rounds}")
    return round - 1
