"""``mutabot compare``: families of operators side by side."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415, PLR0917

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from mutabot.cli import options
from mutabot.cli.output import exit_as, print_json, progress_shown
from mutabot.cli.request import request_of
from mutabot.errors import UsageError
from mutabot.families import FAMILIES, GRADED
from mutabot.journal.files import COMPARISON, find_journal

if TYPE_CHECKING:
    from mutabot.analysis.families import FamilyComparison


def compare(
    context: typer.Context,
    family: options.Families = None,
    only: options.Only = None,
    skip: options.Skip = None,
    selection: options.Selection = None,
    sample: options.Sample = None,
    one_per_site: options.OnePerSite = False,
    rounds: options.Rounds = None,
    seed: options.Seed = None,
    jobs: options.Jobs = None,
    engine: options.Engine = "auto",
    fresh: options.Fresh = False,
    no_oracle: options.NoOracle = False,
    picture: options.Picture = None,
    stored: options.Stored = False,
    json: options.Json = False,
) -> None:
    """Compare families of operators: cost, ends, scores, and what their mutants can tell.

    Mutants run against every test that reaches them, into a journal of their own.
    """
    from mutabot.analysis.gate import decide
    from mutabot.report.picture_file import check_picture

    from . import comparison

    if picture is not None:
        check_picture(picture)
    if stored:
        found = comparison.read(find_journal(context.obj, COMPARISON).parent)
    else:
        request = request_of(
            context.obj, only=only, skip=skip, family=_families(family), order=1,
            selection=selection, sample=sample, one_per_site=one_per_site, rounds=rounds, seed=seed,
            jobs=jobs, engine=engine, fresh=fresh, configured_selection=False,
        )  # fmt: skip
        with progress_shown() as progress:
            found = comparison.run(request, progress, no_oracle=no_oracle)
    _show(found, picture, json=json)
    exit_as(decide(found.results))


def _families(given: Sequence[str] | None) -> Sequence[str]:
    """Those to compare. Raises UsageError for graded mutants, which have no score to be compared."""
    if given is None:
        return [name for name in FAMILIES if name != GRADED]
    if GRADED in {name.strip() for text in given for name in text.split(",")}:
        raise UsageError(
            "graded mutants have thresholds and no score: `mutabot run --family graded`, then "
            "`mutabot thresholds --compare OLD`"
        )
    return given


def _show(comparison: FamilyComparison, picture: Path | None, *, json: bool) -> None:
    from mutabot.report.comparison_json import comparison_data
    from mutabot.report.picture_file import write_picture
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.side_by_side import print_comparison

    if json:
        print_json(comparison_data(comparison))
    else:
        print_comparison(make_console(), comparison)
    if picture is not None:
        write_picture(comparison, picture)
