"""Commands that read the journal alone: ``results``, ``show``, ``thresholds`` and ``report``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing
from itertools import zip_longest
from pathlib import Path, PurePosixPath
from typing import Annotated

from typer import Option

from mutabot.cli import options
from mutabot.cli.context import CommandContext
from mutabot.errors import JournalError, UsageError
from mutabot.report.document import shown_data
from mutabot.report.format import Format, Material, format_of, names
from mutabot.report.html.folder import Contents, check_folder, write_folder
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.mutant import print_mutant
from mutabot.report.terminal.thresholds import print_thresholds
from mutabot.report.texts import Cleaner, portable
from mutabot.results.films import kept_films
from mutabot.results.results import Results
from mutabot.results.suggested import kept_suggestions
from mutabot.thresholds.thresholds import thresholds_of

#: stands for standard output
_STANDARD = Path("-")

_FORMAT = f"One of {', '.join(names())}. Repeatable, each with an --output."
_OUTPUT = "File for the format, in the same order; - is standard output."
_HTML = "Write pages for a browser into this folder."
_PREFIX = "Folder of the project in its repository."
_Formats = Annotated[list[str] | None, Option("--format", metavar="NAME", help=_FORMAT)]
_Outputs = Annotated[list[Path] | None, Option("--output", "-o", metavar="FILE", help=_OUTPUT)]
_Html = Annotated[Path | None, Option("--html", metavar="DIR", help=_HTML)]
_Prefix = Annotated[str, Option("--prefix", metavar="FOLDER", help=_PREFIX)]


def results(context: CommandContext, json: bool = False) -> None:
    """List the mutants and scores of the last campaign.

    Also of a campaign that was interrupted or still runs.
    """
    context.show_results(context.journal, json=json, earlier=True)


def show(
    context: CommandContext,
    mutant: str,
    all: options.EveryRound = False,
    json: bool = False,
) -> None:
    """Show the details of one mutant."""
    found = context.results(earlier=True)
    result = found.mutant(mutant)
    is_there = not result.outdated or result.mutant.family in found.meta.get("families", ())
    source = found.source if is_there else lambda _: None
    suggestion = kept_suggestions(context.journal, found.meta).get(result.mutant.id)
    if json:
        context.print_json(shown_data(result, source, suggestion))
    else:
        print_mutant(make_console(), result, source, suggestion, everything=all)


def thresholds(context: CommandContext, json: bool = False) -> None:
    """Show how large a fault must be before the tests notice it."""
    results = context.results()
    if not results.ladders:
        none = "the campaign has no graded mutants; `mutabot run --family graded` creates them"
        raise JournalError(f"{context.journal}: {none}")
    found = thresholds_of(results)
    context.print_json(found) if json else print_thresholds(make_console(), found)


def report(
    context: CommandContext,
    format: _Formats = None,
    output: _Outputs = None,
    html: _Html = None,
    prefix: _Prefix = "",
) -> None:
    """Write the last campaign as HTML pages or in formats of other tools."""
    wanted = list(_wanted(format or (), output or ()))
    if not wanted and html is None:
        raise UsageError(f"say which --format to write: {', '.join(names())}; or --html with a folder")
    if html is not None:
        check_folder(html)
    folder = PurePosixPath(prefix)
    if folder.is_absolute() or ".." in folder.parts:
        raise UsageError(f"--prefix {prefix} must be a folder inside the repository, relative to its root")
    stored = context.results()
    campaign = portable(stored)
    material = Material(campaign, "" if folder == PurePosixPath() else str(folder))
    for make, file in wanted:
        _write(context, make(material), file)
    if html is not None:
        _write_pages(context, html, campaign, stored.meta.get("root"))
    if not campaign.is_complete:
        context.notify([f"mutabot: the campaign is not complete ({campaign.state}): {campaign.known}"])


def _wanted(names: Sequence[str], files: Sequence[Path]) -> Iterator[tuple[Format, Path]]:
    """Yield each format with its file. Raises UsageError if they do not go together or cannot be written."""
    if len(files) > len(names) or (len(names) > 1 and len(files) < len(names)):
        raise UsageError(
            f"{len(names)} formats and {len(files)} files: each --format takes one --output, in the same "
            "order; without --output, a single format goes to standard output"
        )
    for name, given in zip_longest(names, files, fillvalue=_STANDARD):
        file = Path(given)
        found = format_of(str(name))
        if file != _STANDARD and file.is_dir():
            raise UsageError(f"the report {file} cannot be written: it is a folder")
        if file != _STANDARD and not file.parent.is_dir():
            raise UsageError(f"the report {file} cannot be written: there is no folder {file.parent}")
        yield found, file


def _write(context: CommandContext, text: str, file: Path) -> None:
    data = (text if text.endswith("\n") else f"{text}\n").encode()
    if file == _STANDARD:
        context.print_bytes(data)
        return
    try:
        file.write_bytes(data)
    except OSError as error:
        raise UsageError(f"the report {file} cannot be written: {error.strerror}") from error


def _write_pages(context: CommandContext, folder: Path, campaign: Results, root: str | None) -> None:
    name = Path(root).name if root else ""
    with closing(context.recordings()) as evidence:
        suggestions = kept_suggestions(context.journal, campaign.meta)
        films = kept_films(context.journal, campaign.meta)
        contents = Contents(campaign, name, evidence, Cleaner(root), suggestions, films)
        written = write_folder(folder, contents)
    context.notify([f"mutabot: open {written.page} in a browser ({written.size / 1e6:.1f} MB in its folder)"])
    if written.without:
        context.notify([f"mutabot: {written.without} recordings had no room; their pages say so"])
