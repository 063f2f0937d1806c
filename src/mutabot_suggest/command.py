"""``mutabot suggest``: checks for the survivors of the last campaign."""

from __future__ import annotations

from typing import Annotated

import typer

from mutabot.campaign.selection import select
from mutabot.cli import options
from mutabot.cli.output import print_json, progress_shown
from mutabot.cli.request import request_again
from mutabot.errors import NothingToDoError
from mutabot.journal.files import find_journal
from mutabot.model import Verdict
from mutabot.report.terminal.console import make_console
from mutabot.report.texts import status_of
from mutabot.results.results import MutantResult, Results, results_at
from mutabot.results.suggested import keep_suggestions

from .shown import data_of_suggestions, print_suggestions

#: fresh seeds: each is run
_MOST_SEEDS = 10_000

_Seeds = Annotated[
    int,
    typer.Option(
        "--seeds",
        metavar="N",
        min=5,
        max=_MOST_SEEDS,
        help="New seeds for the tolerances, and as many for the proof.",
    ),
]


def suggest(
    context: typer.Context,
    only: options.Only = None,
    skip: options.Skip = None,
    seeds: _Seeds = 20,
    jobs: options.Jobs = None,
    json: options.Json = False,
) -> None:
    """Suggest checks that kill survivors.

    Each check is verified by running it with the mutant and with new seeds of the original.
    """
    from .suggest import suggest as find_checks  # noqa: PLC0415  # it loads much

    path = find_journal(context.obj)
    results = results_at(path)
    chosen = _chosen(results, only, skip)
    request = request_again(path.parent.parent, results, jobs)
    with progress_shown() as progress:
        found = find_checks(request, chosen, progress, seeds=seeds)
    keep_suggestions(path, results.meta, found)
    print_json(data_of_suggestions(found)) if json else print_suggestions(make_console(), found)


def _chosen(results: Results, only: list[str] | None, skip: list[str] | None) -> list[MutantResult]:
    """Return the survivors that were asked for. Raises NothingToDoError if there is none, saying why."""
    if results.graded and not results.mutants:
        raise NothingToDoError("graded mutants have no survivors but thresholds: `mutabot thresholds`")
    if not results.mutants:
        raise NothingToDoError(f"the journal holds no mutants ({results.state}): run `mutabot run` first")
    if not results.done:
        raise NothingToDoError("no mutant has been run yet: continue with `mutabot run`")
    mutants = select([one.mutant for one in results.mutants], tuple(only or ()), tuple(skip or ()), None)
    # where no test comes, no check helps
    reached = (one for one in results.survivors if status_of(one) is not Verdict.NOT_COVERED)
    survivors = {one.mutant.id: one for one in reached}
    if not survivors:
        raise NothingToDoError("no mutant survived: there is no check to suggest")
    chosen = [survivors[mutant.id] for mutant in mutants if mutant.id in survivors]
    if not chosen:
        raise NothingToDoError("none of the mutants that were asked for survived")
    return chosen
