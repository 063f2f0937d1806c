"""``mutabot report``: the last campaign as pages, in formats of other tools, and beside an older one."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import closing
from itertools import zip_longest
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Annotated

import typer

from mutabot.errors import UsageError
from mutabot.journal.files import find_journal

from . import options
from .output import print_json, tell

if TYPE_CHECKING:
    from mutabot.report.format import Format, Material
    from mutabot.results.results import Results
    from mutabot.results.stored import Changes

_FOLDER = Path(__file__).parent.parent / "report" / "formats"
#: a format is a file; its name is told without loading it, so that `--help` is fast
FORMATS = tuple(sorted(file.stem.replace("_", "-") for file in _FOLDER.glob("[!_]*.py")))
#: stands for standard output
_STANDARD = Path("-")

Formats = Annotated[
    list[str] | None,
    typer.Option(
        "--format",
        metavar="NAME",
        help=f"One of {', '.join(FORMATS)}, or of a package. Repeatable, each with an --output.",
        autocompletion=lambda: [*_names()],
    ),
]
Outputs = Annotated[
    list[Path] | None,
    typer.Option(
        "--output", "-o", metavar="FILE", help="File for the format, in the same order; - is standard output."
    ),
]
Html = Annotated[
    Path | None,
    typer.Option(
        "--html",
        metavar="DIR",
        help="Write pages for a browser into this folder, to be opened from disk: DIR/index.html.",
    ),
]
Prefix = Annotated[
    str, typer.Option("--prefix", metavar="FOLDER", help="Folder of the project in its repository.")
]


def report(
    context: typer.Context,
    format: Formats = None,
    output: Outputs = None,
    html: Html = None,
    compare: options.Compared = None,
    prefix: Prefix = "",
    json: options.Json = False,
) -> None:
    """Write the last campaign as pages or in formats of other tools, or tell what differs from an older one.

    It reads the journal alone, also that of a campaign that was interrupted or still runs.
    """
    from mutabot.report.changes import print_changes
    from mutabot.report.format import Material
    from mutabot.report.terminal.console import make_console
    from mutabot.report.texts import portable
    from mutabot.results.results import results_at

    wanted = list(_wanted(format or (), output or ()))
    if not wanted and compare is None and html is None:
        raise UsageError(
            f"say which --format to write: {', '.join(_names())}; or --html with a folder; "
            "or --compare with what"
        )
    if html is not None:
        _check_folder(html, with_changes=compare is not None)
    for one, _ in wanted:
        if compare is not None and not one.tells_changes:
            raise UsageError(f"the format {one.name} cannot hold a comparison; markdown can")
    if json and (wanted or html is not None or compare is None):
        raise UsageError("--json goes with --compare alone; `mutabot results --json` prints the results")
    journal = find_journal(context.obj)
    stored = results_at(journal)
    campaign = portable(stored)
    changes = _changes(campaign, journal, compare) if compare is not None else None
    material = Material(campaign, _folder(prefix), changes)
    if changes is not None and not wanted:
        print_json(changes) if json else print_changes(make_console(), changes)
    for one, file in wanted:
        _write(one, material, file)
    if html is not None:
        _write_pages(html, campaign, journal, stored.meta.get("root"))
    if not campaign.is_complete:
        tell([f"mutabot: the campaign is not complete ({campaign.state}): {campaign.known}"])


def _names() -> list[str]:
    from mutabot.report.format import names

    return names()


def _wanted(names: Sequence[str], files: Sequence[Path]) -> Iterator[tuple[Format, Path]]:
    """Each format with its file. Raises UsageError if they do not go together."""
    from mutabot.report.format import format_of

    if len(files) > len(names) or (len(names) > 1 and len(files) < len(names)):
        raise UsageError(
            f"{len(names)} formats and {len(files)} files: each --format takes one --output, in the same "
            "order; a single format goes to standard output without"
        )
    for name, file in zip_longest(names, files, fillvalue=_STANDARD):
        found = format_of(str(name))
        if file != _STANDARD:
            _check(Path(file))
        yield found, Path(file)


def _check(file: Path) -> None:
    """Raise UsageError for a file that could not be written, before anything is."""
    if file.is_dir():
        raise UsageError(f"the report {file} cannot be written: it is a folder")
    if not file.parent.is_dir():
        raise UsageError(f"the report {file} cannot be written: there is no folder {file.parent}")


def _check_folder(folder: Path, *, with_changes: bool) -> None:
    """Raise UsageError for pages that could not be written, before anything is."""
    from mutabot.report.html.folder import check_folder

    if with_changes:
        raise UsageError("--html cannot hold a comparison; --format markdown can")
    check_folder(folder)


def _write_pages(folder: Path, campaign: Results, journal: Path, root: str | None) -> None:
    from mutabot.report.html.folder import Contents, write_folder
    from mutabot.report.texts import Cleaner
    from mutabot.results.stored import StoredEvidence
    from mutabot.results.suggested import kept_suggestions

    name = Path(root).name if root else ""
    with closing(StoredEvidence(journal)) as evidence:
        suggestions = kept_suggestions(journal, campaign.meta)
        written = write_folder(folder, Contents(campaign, name, evidence, Cleaner(root), suggestions))
    lines = [f"mutabot: {written.page}, {written.size / 1e6:.1f} MB in its folder: open it in a browser"]
    if written.without:
        lines.append(
            f"mutabot: there was no room for {written.without} recordings; pages say where they are missing"
        )
    tell(lines)


def _folder(prefix: str) -> str:
    """A folder in a repository, in one way of writing it. Raises UsageError if it leads out of it."""
    folder = PurePosixPath(prefix)
    if folder.is_absolute() or ".." in folder.parts:
        raise UsageError(f"--prefix {prefix} must be a folder inside the repository, relative to its root")
    return "" if folder == PurePosixPath() else str(folder)


def _changes(campaign: Results, journal: Path, old: Path) -> Changes:
    from mutabot.journal.files import previous_of
    from mutabot.report.texts import portable
    from mutabot.results.results import results_at
    from mutabot.results.stored import changes, journal_at

    other = journal_at(old)
    if other.exists() and journal.exists() and other.samefile(journal):
        raise UsageError(
            f"{old} is the campaign itself; the last complete one before it, if there was any, is in "
            f"{previous_of(journal).name} beside it"
        )
    return changes(portable(results_at(other)), campaign)


def _write(format: Format, material: Material, file: Path) -> None:
    text = format.make(material)
    data = (text if text.endswith("\n") else f"{text}\n").encode()
    if file == _STANDARD:
        _print(data)
        return
    try:
        file.write_bytes(data)
    except OSError as error:
        raise UsageError(f"the report {file} cannot be written: {error.strerror}") from error


def _print(data: bytes) -> None:
    """Print as it is, in UTF-8 whatever the terminal has, also where the reader leaves early."""
    from mutabot.report.terminal.console import leave_pipe

    try:
        sys.stdout.flush()
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
    except BrokenPipeError:
        leave_pipe()
