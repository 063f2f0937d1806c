"""``mutabot suggest``: proposes checks for the survivors of the last campaign."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import typer

from mutabot.api.reports import CommandContext, MutantResult, Results, UsageError, Verdict

from .output import data_of_suggestions, keep, print_suggestions
from .results import NothingToSuggestError

#: fresh seeds: each is run
_MOST_SEEDS = 10_000

_Seeds = Annotated[
    int,
    typer.Option(
        "--seeds",
        metavar="N",
        min=3,
        max=_MOST_SEEDS,
        help="New seeds for the tolerances, and as many for the proof.",
    ),
]


def suggest(
    context: CommandContext,
    only: list[str] | None = None,
    skip: list[str] | None = None,
    seeds: _Seeds = 5,
    jobs: int | None = None,
    json: bool = False,
) -> None:
    """Suggest checks that kill survivors.

    Each check is verified by running it with the mutant and with new seeds of the original.
    """
    from .suggest import suggest as find_checks  # noqa: PLC0415  # it loads much

    results = context.results()
    chosen = _survivors_of(results, _selected(context, results, only or (), skip or ()))
    request = context.request_again(results, jobs)
    with context.progress() as progress:
        found = find_checks(request, chosen, progress, seeds=seeds)
    keep(context, results, found)
    context.print_json(data_of_suggestions(found)) if json else print_suggestions(context, found)


def _selected(
    context: CommandContext, results: Results, only: Sequence[str], skip: Sequence[str]
) -> list[MutantResult]:
    """Return the requested mutants of the last campaign. Raises NothingToSuggestError if it has no such."""
    if not results.mutants:
        return []
    try:
        return results.selected(only, skip)
    except UsageError:
        context.results(earlier=True).selected(only, skip)  # raises for what no campaign has
        raise NothingToSuggestError(
            "the last campaign did not run these mutants: run them again, without --only or with it"
        ) from None


def _survivors_of(results: Results, selected: Sequence[MutantResult]) -> list[MutantResult]:
    """Return the survivors. Raises NothingToSuggestError, with the reason, if there is none."""
    if results.graded and not results.mutants:
        raise NothingToSuggestError("graded mutants have no survivors but thresholds: `mutabot thresholds`")
    if not results.mutants:
        raise NothingToSuggestError(
            f"the journal holds no mutants ({results.state}): run `mutabot run` first"
        )
    if not results.done:
        raise NothingToSuggestError("no mutant has been run yet: `mutabot run` runs them")
    # where no test comes, no check helps
    survivors = [survivor for survivor in results.survivors if survivor.status is not Verdict.NOT_COVERED]
    if not survivors:
        of = results.selected_of
        which = (
            "no mutant" if of is None else f"none of the {len(results.mutants)} mutants of the last campaign"
        )
        more = "" if of is None else f"; `mutabot run` runs all {of}"
        raise NothingToSuggestError(f"{which} survived: there is no check to suggest{more}")
    chosen = [result for result in selected if result in survivors]
    if not chosen and any(result.is_accepted for result in selected):
        raise NothingToSuggestError("these survivors are accepted: `mutabot accept` lists them")
    if not chosen:
        raise NothingToSuggestError("none of the selected mutants survived")
    return chosen
