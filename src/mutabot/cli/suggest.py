"""``mutabot suggest``: checks that kill the survivors of the last campaign."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from mutabot import limits
from mutabot.errors import NothingToDoError
from mutabot.journal.files import find_journal

from . import options
from .output import print_json, progress_shown
from .request import request_again

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mutabot.analysis.results import MutantResult, Results

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


def suggest(
    context: typer.Context,
    only: options.Only = None,
    skip: options.Skip = None,
    seeds: Seeds = 20,
    jobs: options.Jobs = None,
    json: options.Json = False,
) -> None:
    """Suggest checks that kill survivors of the last campaign, each proven by running it."""
    from mutabot.analysis.results import read_results
    from mutabot.analysis.suggested import keep_suggestions
    from mutabot.journal.reader import JournalReader
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.suggested import print_suggestions, suggested_data
    from mutabot.suggestion import suggest as find_checks

    path = find_journal(context.obj)
    with JournalReader.open(path) as journal:
        results = read_results(journal)
    chosen = _chosen(results, only, skip)
    request = request_again(path.parent.parent, results, jobs)
    with progress_shown() as progress:
        found = find_checks(request, results, chosen, progress, seeds=seeds)
    keep_suggestions(path, results.meta, found)
    print_json(suggested_data(found)) if json else print_suggestions(make_console(), found)


def _chosen(results: Results, only: list[str] | None, skip: list[str] | None) -> list[MutantResult]:
    """The survivors that were asked for. Raises NothingToDoError if there is none, saying why."""
    from mutabot.campaign.plan.selection import select

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
