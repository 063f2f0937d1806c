"""What differs between two campaigns, on the terminal."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from mutabot.analysis.stored.changes import Changes
from mutabot.report.terminal.campaign import WIDE
from mutabot.report.terminal.console import (
    add_row,
    heading,
    make_mutant_table,
    make_table,
    plain,
    short_place,
)

from .sections import Section, notes, score_rows, sections, summary

#: mutants of a section that are shown
_SHOWN = 50


def print_changes(console: Console, changes: Changes) -> None:
    """Print what differs."""
    for part in _parts(changes, console.width):
        console.print(part)


def _parts(changes: Changes, width: int) -> Iterator[RenderableType]:
    yield Text(summary(changes), style="bold")
    for line in notes(changes):
        yield Text(plain(line), style="bold")
    yield _scores(changes)
    for section in sections(changes):
        yield heading(f"{section.heading}: {len(section.rows)}")
        yield _mutants(section, width)
        if len(section.rows) > _SHOWN:
            yield Text(f"and {len(section.rows) - _SHOWN} more", style="dim")


def _scores(changes: Changes) -> Table:
    table = make_table()
    table.add_column("family · role")
    for name in ("old", "new", "points"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in score_rows(changes):
        table.add_row(*row)
    return table


def _mutants(section: Section, width: int) -> Table:
    narrow = width < WIDE
    table = make_mutant_table(("place", "operator"), "what it does, and how it ended", narrow=narrow)
    for result, told in section.rows[:_SHOWN]:
        mutant = result.mutant
        facts = (short_place(mutant.site.span.file, mutant.site.span.line), mutant.operator)
        add_row(table, mutant.number, facts, f"{mutant.description}\n{told}", narrow=narrow)
    return table
