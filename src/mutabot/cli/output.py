"""What commands print, and where: results and JSON on standard output, progress on standard error."""

# What is printed is imported when it is, so that `--help` is fast.
# ruff: noqa: PLC0415

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from mutabot.config.configuration import Configuration
    from mutabot.report.terminal.progress import Bar, Lines
    from mutabot.results.gate import Decision
    from mutabot.results.results import Results


def echo(text: str) -> None:
    """Print, also where the reader leaves early: then the exit code still tells how it ended."""
    from mutabot.report.terminal.console import leave_pipe

    try:
        typer.echo(text)
    except BrokenPipeError:
        leave_pipe()


def tell(lines: Iterable[str]) -> None:
    """Print lines on standard error, where they are in the way of no other program."""
    for line in lines:
        typer.echo(line, err=True)


def print_json(data: Any) -> None:
    """Print data as JSON, as docs/json.md tells it."""
    from mutabot.report.document import data_of, dumps

    echo(dumps(data_of(data)))


def progress_shown() -> Bar | Lines:
    """What shows on standard error how far a campaign is."""
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.progress import make_progress

    return make_progress(make_console(stderr=True))


def show_results(
    path: Path, *, json: bool, everything: bool = False, earlier: bool = False, summary: bool = False
) -> Results:
    """Print what the journal at ``path`` holds, and return it.

    ``everything``: also what the plan left out. ``earlier``: also what earlier campaigns found. ``summary``:
    without the table of mutants.
    """
    from mutabot.report.terminal.campaign import print_results, print_summary
    from mutabot.report.terminal.console import make_console
    from mutabot.results.results import results_at

    found = results_at(path, earlier=earlier)
    if json:
        from mutabot.report.document import document

        print_json(document(found))
    elif summary:
        print_summary(make_console(), found)
    else:
        print_results(make_console(), found, everything=everything)
    return found


def decided(configuration: Configuration, results: Results, min_score: float | None) -> Decision:
    """Results held against the limits of the configuration.

    Args:
        min_score: in percent, in the place of the configured one.
    """
    from mutabot.results.gate import decide

    limit = min_score if min_score is not None else configuration.min_score
    return decide(
        results,
        min_score=None if limit is None else limit / 100,
        max_timeouts=configuration.timeout_limit,
        max_unstable=configuration.unstable_limit,
        max_errors=configuration.error_limit,
        demands=configuration.demands,
    )


def exit_as(decision: Decision) -> None:
    """End the command as the limits decide, and say why. Raises typer.Exit."""
    tell(decision.lines)
    raise typer.Exit(decision.exit_code)
