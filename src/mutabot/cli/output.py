"""Output of commands: results and JSON on standard output, progress and remarks on standard error."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import typer

from mutabot.cli.streams import output_failed
from mutabot.report.document import data_of, document, dumps
from mutabot.report.terminal.campaign import print_results, print_summary
from mutabot.report.terminal.console import Bar, Lines, leave_pipe, make_console, make_progress
from mutabot.results.results import Results, results_at


def echo(text: str) -> None:
    """Print a text. A reader that leaves early does not change the exit code."""
    print_bytes(f"{text}\n".encode(sys.stdout.encoding or "utf-8", errors="replace"))


def print_bytes(data: bytes) -> None:
    """Print bytes as they are, in UTF-8 whatever the terminal has."""
    try:
        sys.stdout.flush()
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
    except BrokenPipeError:
        leave_pipe()
    except OSError as error:
        output_failed(error)


def tell(lines: Iterable[str]) -> None:
    """Print lines on standard error, so that they do not mix with results."""
    for line in lines:
        typer.echo(line, err=True)


def print_json(data: Any) -> None:
    """Print data as JSON, as docs/json.md describes it."""
    echo(dumps(data_of(data)))


def progress_shown() -> Bar | Lines:
    """Return what shows the progress of a campaign on standard error."""
    return make_progress(make_console(stderr=True))


def show_results(path: Path, *, json: bool, earlier: bool = False, summary: bool = False) -> Results:
    """Print what the journal at ``path`` holds, and return it.

    Args:
        earlier: also show what earlier campaigns found.
        summary: leave out the table of mutants.
    """
    found = results_at(path, earlier=earlier)
    if json:
        print_json(document(found))
    elif summary:
        print_summary(make_console(), found)
    else:
        print_results(make_console(), found)
    return found
