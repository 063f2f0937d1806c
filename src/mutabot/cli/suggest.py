"""``mutabot suggest``: checks that kill the survivors of the last campaign."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mutabot import limits
from mutabot.errors import NothingToDoError, UsageError
from mutabot.journal.files import find_journal

from . import options
from .output import print_json, progress_shown, tell
from .request import request_again

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mutabot.analysis.results import MutantResult, Results

Write = Annotated[
    Path | None,
    typer.Option("--write", metavar="FILE", help="Write them as a new test file instead of printing a diff."),
]
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
    write: Write = None,
    jobs: options.Jobs = None,
    json: options.Json = False,
) -> None:
    """Suggest checks that kill survivors of the last campaign, each proven by running it."""
    from mutabot.analysis.results import read_results
    from mutabot.analysis.stored.suggested import keep_suggestions
    from mutabot.journal.reader import JournalReader
    from mutabot.report.suggested.data import suggested_data
    from mutabot.report.suggested.text import print_suggestions
    from mutabot.report.terminal.console import make_console
    from mutabot.suggestion import suggest as find_checks

    path = find_journal(context.obj)
    with JournalReader.open(path) as journal:
        results = read_results(journal)
    root = path.parent.parent
    file = _new_file(write, root) if write is not None else None
    chosen = _chosen(results, only, skip)
    request = request_again(root, results, jobs)
    with progress_shown() as progress:
        found = find_checks(request, results, chosen, progress, seeds=seeds, write=file)
    for name in found.files:
        if (root / name).exists():
            raise UsageError(f"{name} exists; --write makes new files and changes none")
    keep_suggestions(path, results.meta, found)
    for name, text in found.files.items():
        _write(root / name, text)
    print_json(suggested_data(found)) if json else print_suggestions(make_console(), found)
    tell(f"written: {name}" for name in found.files)


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


def _new_file(write: Path, root: Path) -> str:
    """The file relative to the project. Raises UsageError if it cannot be a new test file."""
    path = write if write.is_absolute() else Path.cwd() / write
    if not path.resolve().is_relative_to(root.resolve()):
        raise UsageError(f"{write} is not in the project {root}: a test file must be among its tests")
    if path.exists():
        raise UsageError(f"{path} exists; --write makes a new file and changes none")
    if not path.parent.is_dir():
        raise UsageError(f"there is no folder {path.parent}")
    if path.suffix != ".py":
        raise UsageError(f"{write} is no Python file; write it like tests/test_suggested.py")
    return str(path.resolve().relative_to(root.resolve()))


def _write(path: Path, text: str) -> None:
    """Raises UsageError if there is such a file by now, or it cannot be written."""
    try:
        with path.open("x", encoding="utf-8", newline="") as file:
            file.write(text)
    except OSError as error:
        raise UsageError(f"{path} cannot be written: {error.strerror}") from error
