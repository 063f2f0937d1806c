"""Commands that read the journal alone: ``results``, ``show``, ``thresholds`` and ``report``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing
from itertools import zip_longest
from pathlib import Path, PurePosixPath
from typing import Annotated

import typer

from mutabot.cli import options
from mutabot.cli.output import echo, print_bytes, print_json, show_results, tell
from mutabot.errors import JournalError, UsageError
from mutabot.journal.files import find_journal, previous_of
from mutabot.report.changes import print_changes
from mutabot.report.format import Format, Material, format_of, names
from mutabot.report.html.folder import Contents, check_folder, write_folder
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.mutant import print_mutant
from mutabot.report.texts import Cleaner, portable
from mutabot.report.thresholds import print_compared, print_thresholds, suggested_toml
from mutabot.results.results import Results, find_mutant, results_at
from mutabot.results.stored import Changes, StoredEvidence, journal_at
from mutabot.results.stored import changes as changes_between
from mutabot.results.suggested import kept_suggestions
from mutabot.results.thresholds import compare as compared
from mutabot.results.thresholds import thresholds_of

#: stands for standard output
_STANDARD = Path("-")

_Demands = Annotated[
    bool, typer.Option("--suggest-demands", help="Print demands that this campaign meets, as TOML.")
]
_Formats = Annotated[
    list[str] | None,
    typer.Option(
        "--format",
        metavar="NAME",
        help=f"One of {', '.join(names())}. Repeatable, each with an --output.",
        autocompletion=names,
    ),
]
_Outputs = Annotated[
    list[Path] | None,
    typer.Option(
        "--output", "-o", metavar="FILE", help="File for the format, in the same order; - is standard output."
    ),
]
_Html = Annotated[
    Path | None,
    typer.Option("--html", metavar="DIR", help="Write pages for a browser into this folder."),
]
_Prefix = Annotated[
    str, typer.Option("--prefix", metavar="FOLDER", help="Folder of the project in its repository.")
]


def results(context: typer.Context, all: options.All = False, json: options.Json = False) -> None:
    """List the mutants and scores of the last campaign.

    Also of a campaign that was interrupted or still runs.
    """
    show_results(find_journal(context.obj), json=json, everything=all, earlier=True)


def show(
    context: typer.Context,
    mutant: options.OneMutant,
    all: options.EveryRound = False,
    json: options.Json = False,
) -> None:
    """Show the details of one mutant."""
    path = find_journal(context.obj)
    found = results_at(path, earlier=True)
    result = find_mutant(found, mutant)
    is_there = not result.outdated or result.mutant.family in found.meta.get("families", ())
    source = found.source(result.mutant.site.span.file) if is_there else None
    if json:
        print_json(result)
    else:
        suggestions = kept_suggestions(path, found.meta)
        print_mutant(make_console(), result, source, suggestions, everything=all)


def thresholds(
    context: typer.Context,
    compare: options.Compared = None,
    suggest_demands: _Demands = False,
    json: options.Json = False,
) -> None:
    """Show how large a fault must be before the tests notice it."""
    if suggest_demands and (json or compare is not None):
        raise UsageError("--suggest-demands prints TOML alone")
    journal = find_journal(context.obj)
    results = _graded(journal)
    if compare is not None:
        other = journal_at(compare)
        _check_other(
            other, journal, f"{compare} is the campaign itself; keep a copy of its journal to compare"
        )
        comparison = compared(_graded(other), results)
        print_json(comparison) if json else print_compared(make_console(), comparison)
        return
    found = thresholds_of(results)
    if suggest_demands:
        table = "demand" if (context.obj / "mutabot.toml").is_file() else "tool.mutabot.demand"
        echo(suggested_toml(found.ladders, table=table))
    else:
        print_json(found) if json else print_thresholds(make_console(), found)


def _graded(journal: Path) -> Results:
    """Read a journal. Raises JournalError if it holds no graded mutants."""
    found = results_at(journal)
    if not found.ladders:
        raise JournalError(
            f"{journal}: the campaign has no graded mutants; `mutabot run --family graded` plants them"
        )
    return found


def _check_other(other: Path, journal: Path, problem: str) -> None:
    if other.exists() and journal.exists() and other.samefile(journal):
        raise UsageError(problem)


def report(
    context: typer.Context,
    format: _Formats = None,
    output: _Outputs = None,
    html: _Html = None,
    compare: options.Compared = None,
    prefix: _Prefix = "",
    json: options.Json = False,
) -> None:
    """Write the last campaign as HTML pages or in formats of other tools.

    With --compare alone, print how it differs from an older campaign.
    """
    wanted = list(_wanted(format or (), output or ()))
    if not wanted and compare is None and html is None:
        raise UsageError(
            f"say which --format to write: {', '.join(names())}; or --html with a folder; or --compare"
        )
    if html is not None:
        check_folder(html)
    unfit = ["--html"] if html is not None else []
    unfit += [f"the format {one.name}" for one, _ in wanted if not one.tells_changes]
    if compare is not None and unfit:
        raise UsageError(f"{unfit[0]} cannot hold a comparison; markdown can")
    if json and (wanted or html is not None or compare is None):
        raise UsageError("--json goes with --compare alone; `mutabot results --json` prints the results")
    journal, folder = find_journal(context.obj), PurePosixPath(prefix)
    if folder.is_absolute() or ".." in folder.parts:
        raise UsageError(f"--prefix {prefix} must be a folder inside the repository, relative to its root")
    stored = results_at(journal)
    campaign = portable(stored)
    changes = None
    if compare is not None:
        changes = _changes(campaign, journal, compare)
        if not wanted:
            print_json(changes) if json else print_changes(make_console(), changes)
    material = Material(campaign, "" if folder == PurePosixPath() else str(folder), changes)
    for one, file in wanted:
        _write(one.make(material), file)
    if html is not None:
        _write_pages(html, campaign, journal, stored.meta.get("root"))
    if not campaign.is_complete:
        tell([f"mutabot: the campaign is not complete ({campaign.state}): {campaign.known}"])


def _wanted(names: Sequence[str], files: Sequence[Path]) -> Iterator[tuple[Format, Path]]:
    """Yield each format with its file. Raises UsageError if they do not go together or cannot be written."""
    if len(files) > len(names) or (len(names) > 1 and len(files) < len(names)):
        raise UsageError(
            f"{len(names)} formats and {len(files)} files: each --format takes one --output, in the same "
            "order; a single format goes to standard output without"
        )
    for name, given in zip_longest(names, files, fillvalue=_STANDARD):
        file = Path(given)
        found = format_of(str(name))
        if file != _STANDARD and file.is_dir():
            raise UsageError(f"the report {file} cannot be written: it is a folder")
        if file != _STANDARD and not file.parent.is_dir():
            raise UsageError(f"the report {file} cannot be written: there is no folder {file.parent}")
        yield found, file


def _changes(campaign: Results, journal: Path, old: Path) -> Changes:

    other = journal_at(old)
    before = f"the last complete one before it, if there was any, is in {previous_of(journal).name} beside it"
    _check_other(other, journal, f"{old} is the campaign itself; {before}")
    return changes_between(portable(results_at(other)), campaign)


def _write(text: str, file: Path) -> None:
    data = (text if text.endswith("\n") else f"{text}\n").encode()
    if file == _STANDARD:
        print_bytes(data)
        return
    try:
        file.write_bytes(data)
    except OSError as error:
        raise UsageError(f"the report {file} cannot be written: {error.strerror}") from error


def _write_pages(folder: Path, campaign: Results, journal: Path, root: str | None) -> None:

    name = Path(root).name if root else ""
    with closing(StoredEvidence(journal)) as evidence:
        suggestions = kept_suggestions(journal, campaign.meta)
        written = write_folder(folder, Contents(campaign, name, evidence, Cleaner(root), suggestions))
    tell([f"mutabot: open {written.page} in a browser ({written.size / 1e6:.1f} MB in its folder)"])
    if written.without:
        tell([f"mutabot: {written.without} recordings had no room; their pages say so"])
