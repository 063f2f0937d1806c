"""``mutabot results`` and ``show``, which load little; ``replay`` and ``suggest``: what the journal holds."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING, Annotated

import typer

from mutabot import limits
from mutabot.cli import options
from mutabot.cli.output import print_json, progress_shown, show_results
from mutabot.cli.request import request_again
from mutabot.errors import ExitCode, NothingToDoError, UsageError
from mutabot.journal.files import find_journal

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mutabot.results.results import MutantResult, Results

Seeds = Annotated[
    int,
    typer.Option(
        "--seeds",
        metavar="N",
        min=5,
        max=limits.SEEDS,
        help="Fresh seeds for the tolerances, and as many for the proof.",
    ),
]


def results(context: typer.Context, all: options.All = False, json: options.Json = False) -> None:
    """Show the results of the last campaign, also of one that was interrupted or still runs."""
    show_results(find_journal(context.obj), json=json, everything=all, earlier=True)


def show(
    context: typer.Context,
    mutant: options.OneMutant,
    json: options.Json = False,
) -> None:
    """Show everything about one mutant."""
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.mutant import print_mutant
    from mutabot.results.results import find_mutant, results_at
    from mutabot.results.stored import StoredEvidence
    from mutabot.results.suggested import kept_suggestions

    path = find_journal(context.obj)
    found = results_at(path, earlier=True)
    result = find_mutant(found, mutant)
    is_there = not result.outdated or result.mutant.family in found.meta.get("families", ())
    source = found.source(result.mutant.site.span.file) if is_there else None
    if json:
        print_json(result)
    else:
        with closing(StoredEvidence(path)) as evidence:
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
    from mutabot.campaign.again import replay_one
    from mutabot.journal.reader import JournalReader
    from mutabot.report.document import replayed as replayed_data
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.mutant import print_replayed
    from mutabot.results.results import find_mutant, read_results

    path = find_journal(context.obj)
    with JournalReader.open(path) as journal:
        found = read_results(journal, earlier=True)
        chosen = find_mutant(found, mutant).mutant
        rounds = range(found.rounds) if round is None else [number_of(round, found.rounds)]
        request = request_again(path.parent.parent, found, jobs)
        with progress_shown() as progress:
            replayed = replay_one(request, journal, chosen, rounds, progress)
    data = replayed_data(chosen, replayed)
    print_json(data) if json else print_replayed(make_console(), chosen, replayed)
    differs = any(one.agrees is False for one in replayed)
    raise typer.Exit(ExitCode.UNRELIABLE if differs else ExitCode.FINE)


def number_of(round: int, rounds: int) -> int:
    """A round as it is counted inside, from 0 on. Raises UsageError if the campaign has fewer."""
    if round > rounds:
        raise UsageError(f"there is no round {round}; the campaign has {rounds}")
    return round - 1


def suggest(
    context: typer.Context,
    only: options.Only = None,
    skip: options.Skip = None,
    seeds: Seeds = 20,
    jobs: options.Jobs = None,
    json: options.Json = False,
) -> None:
    """Suggest checks that kill survivors of the last campaign, each proven by running it."""
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.suggested import print_suggestions
    from mutabot.results.results import results_at
    from mutabot.results.suggested import keep_suggestions
    from mutabot.suggestion import suggest as find_checks

    path = find_journal(context.obj)
    results = results_at(path)
    chosen = _chosen(results, only, skip)
    request = request_again(path.parent.parent, results, jobs)
    with progress_shown() as progress:
        found = find_checks(request, results, chosen, progress, seeds=seeds)
    keep_suggestions(path, results.meta, found)
    print_json(found) if json else print_suggestions(make_console(), found)


def _chosen(results: Results, only: list[str] | None, skip: list[str] | None) -> list[MutantResult]:
    """The survivors that were asked for. Raises NothingToDoError if there is none, saying why."""
    from mutabot.campaign.selection import select

    if results.graded and not results.mutants:
        raise NothingToDoError("graded mutants have no survivors but thresholds: `mutabot thresholds`")
    if not results.mutants:
        raise NothingToDoError(f"the journal holds no mutants ({results.state}): run `mutabot run` first")
    if not results.done:
        raise NothingToDoError("no mutant has been run yet: `mutabot run` goes on")
    mutants = select([one.mutant for one in results.mutants], tuple(only or ()), tuple(skip or ()), None)
    by_id: Mapping[str, MutantResult] = {one.mutant.id: one for one in results.survivors}
    if not by_id:
        raise NothingToDoError("no mutant survived: there is no check to suggest")
    chosen = [by_id[mutant.id] for mutant in mutants if mutant.id in by_id]
    if not chosen:
        raise NothingToDoError("none of the mutants that were asked for survived")
    return chosen
