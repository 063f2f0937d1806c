"""``mutabot thresholds``: how big a graded fault must be before the tests notice."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mutabot.errors import JournalError, UsageError, unknown_name_text
from mutabot.journal.files import find_journal

from . import options
from .output import echo, print_json

if TYPE_CHECKING:
    from mutabot.results.results import Results
    from mutabot.results.thresholds import Thresholds

#: of ``results.thresholds``; told without loading it, so that `--help` is fast
_SORTS = ("loosest", "place", "operator")
_OWN = "mutabot.toml"

Sort = Annotated[
    str,
    typer.Option(
        "--sort", metavar="ORDER", help=f"One of {', '.join(_SORTS)}.", autocompletion=lambda: list(_SORTS)
    ),
]
Steps = Annotated[bool, typer.Option("--steps", help="Also what became of each magnitude.")]
Drawing = Annotated[
    Path | None, typer.Option("--picture", metavar="FILE", help="Also draw a bar for each, as SVG.")
]
Suggest = Annotated[
    bool, typer.Option("--suggest-demands", help="Print demands that this campaign meets, as TOML.")
]


def thresholds(
    context: typer.Context,
    sort: Sort = "loosest",
    steps: Steps = False,
    picture: Drawing = None,
    compare: options.Compared = None,
    suggest_demands: Suggest = False,
    json: options.Json = False,
) -> None:
    """Show from which magnitude on the tests notice graded faults, the loosest first."""
    from mutabot.report.terminal.console import make_console
    from mutabot.report.thresholds.picture import check_picture
    from mutabot.report.thresholds.text import print_thresholds
    from mutabot.results.thresholds import thresholds_of

    if sort not in _SORTS:
        raise UsageError(unknown_name_text("order", sort, _SORTS))
    if suggest_demands and (json or compare is not None or steps):
        raise UsageError("--suggest-demands prints TOML alone")
    if compare is not None and (picture is not None or steps):
        raise UsageError("--compare goes with --json alone")
    if picture is not None:
        check_picture(picture)
    journal = find_journal(context.obj)
    results = _read(journal)
    if compare is not None:
        _compare(results, journal, compare, json=json)
        return
    found = thresholds_of(results, sort)
    if suggest_demands:
        _suggest(found, context.obj)
    elif json:
        print_json(found)
    else:
        print_thresholds(make_console(), found, steps=steps)
    if picture is not None:
        _draw(found, picture)


def _read(journal: Path) -> Results:
    """What a journal holds. Raises JournalError if that are no graded mutants."""
    from mutabot.results.results import results_at

    found = results_at(journal)
    if not found.ladders:
        raise JournalError(
            f"{journal}: the campaign has no graded mutants; `mutabot run --family graded` plants them",
            path=str(journal),
        )
    return found


def _compare(results: Results, journal: Path, old: Path, *, json: bool) -> None:
    from mutabot.report.terminal.console import make_console
    from mutabot.report.thresholds.text import print_compared
    from mutabot.results.stored import journal_at
    from mutabot.results.thresholds import compare

    other = journal_at(old)
    if other.exists() and other.samefile(journal):
        raise UsageError(f"{old} is the campaign itself; keep a copy of its journal to compare with it later")
    comparison = compare(_read(other), results)
    print_json(comparison) if json else print_compared(make_console(), comparison)


def _suggest(found: Thresholds, project: Path) -> None:
    from mutabot.report.thresholds.text import suggested_toml

    table = "demand" if (project / _OWN).is_file() else "tool.mutabot.demand"
    echo(suggested_toml(found.ladders, table=table))


def _draw(found: Thresholds, picture: Path) -> None:
    from mutabot.report.thresholds.picture import picture_of, write_drawing

    if not found.ladders:
        raise UsageError("there is nothing to draw: no ladder could be judged")
    write_drawing(picture_of(found), picture, by="mutabot thresholds")
