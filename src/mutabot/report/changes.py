"""What differs between two campaigns: as text, as JSON and as Markdown, in the same sections."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from mutabot.report.terminal.campaign import WIDE
from mutabot.report.terminal.console import (
    add_row,
    heading,
    make_mutant_table,
    make_table,
    percent,
    plain,
    short_place,
)
from mutabot.report.texts import escaped, table
from mutabot.results.results import MutantResult
from mutabot.results.score import Group
from mutabot.results.stored import Changes, Ends

from .texts import rounds_text

#: a heading, and the mutants of which it is said, each with what happened to it
Section = tuple[str, tuple[tuple[MutantResult, str], ...]]


def sections(changes: Changes) -> Iterator[Section]:
    """The sections that are not empty, what needs action first."""
    pairs = (
        ("New survivors", changes.appeared),
        ("Changed survivors", changes.changed),
        ("Survivors of which nothing is known now", changes.unknown),
        ("Fixed survivors", changes.fixed),
        ("Mutants that are gone", changes.gone),
    )
    for name, found in pairs:
        if found:
            yield name, tuple((pair.either, _told(pair)) for pair in found)
    added = tuple(
        (one.either, rounds_text(one.either)) for one in changes.added if not one.either.is_survivor
    )
    if added:
        yield "New mutants that do not survive", added


def summary(changes: Changes) -> str:
    """The numbers in a line."""
    return (
        f"Survivors: {len(changes.appeared)} new, {len(changes.fixed)} fixed, "
        f"{len(changes.changed)} changed, {changes.same} as before, {len(changes.unknown)} unknown; "
        f"mutants: {len(changes.added)} new, {len(changes.gone)} gone"
    )


def notes(changes: Changes) -> list[str]:
    """What is to be known of campaigns that did not run to their end, or not of the same mutants."""
    states = (("old", changes.old_state), ("new", changes.new_state))
    ends = [f"the {name} campaign is not complete: {state}" for name, state in states if state != "complete"]
    return [*ends, *changes.notes]


def score_rows(changes: Changes) -> Iterator[tuple[str, str, str, str]]:
    """Family and role, the old score, the new one, and the difference in percentage points."""
    for (family, role), (old, new) in changes.scores.items():
        before, after = _mean(old), _mean(new)
        by = f"{100 * (after - before):+.1f}" if before is not None and after is not None else "–"
        yield f"{family} · {role}", percent(before), percent(after), by


def _told(pair: Ends) -> str:
    old = f"before: {rounds_text(pair.old)}" if pair.old is not None else "a new mutant"
    return f"{rounds_text(pair.new)}; {old}" if pair.new is not None else old


def _mean(group: Group | None) -> float | None:
    return group.scores.mean if group is not None else None


#: mutants of a section that are shown
_ROWS = 50


def change_lines(changes: Changes, path: Callable[[str], str]) -> Iterator[str]:
    """The lines. ``path`` names a file of the project as the reader knows it."""
    yield "### Since the older campaign"
    yield ""
    yield f"{summary(changes)}."
    yield ""
    for line in notes(changes):
        yield f"> **{escaped(line)}**"
        yield ""
    yield from table(("family · role", "old", "new", "points"), score_rows(changes), right=(1, 2, 3))
    for title, found in sections(changes):
        yield f"#### {title}: {len(found)}"
        yield ""
        rows = (
            (
                str(result.mutant.number),
                replace(result.mutant.site.span, file=path(result.mutant.site.span.file)).place,
                result.mutant.operator,
                result.mutant.description,
                told,
            )
            for result, told in found[:_ROWS]
        )
        yield from table(("no.", "place", "operator", "what it does", "how it ended"), rows, right=(0,))
        if len(found) > _ROWS:
            yield f"and {len(found) - _ROWS} more"
            yield ""


def print_changes(console: Console, changes: Changes) -> None:
    """Print what differs."""
    for part in _parts(changes, console.width):
        console.print(part)


def _parts(changes: Changes, width: int) -> Iterator[RenderableType]:
    yield Text(summary(changes), style="bold")
    for line in notes(changes):
        yield Text(plain(line), style="bold")
    yield _scores(changes)
    for title, found in sections(changes):
        yield heading(f"{title}: {len(found)}")
        yield _mutants(found, width)
        if len(found) > _ROWS:
            yield Text(f"and {len(found) - _ROWS} more", style="dim")


def _scores(changes: Changes) -> Table:
    table = make_table()
    table.add_column("family · role")
    for name in ("old", "new", "points"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in score_rows(changes):
        table.add_row(*row)
    return table


def _mutants(found: Sequence[tuple[MutantResult, str]], width: int) -> Table:
    narrow = width < WIDE
    table = make_mutant_table(("place", "operator"), "what it does, and how it ended", narrow=narrow)
    for result, told in found[:_ROWS]:
        mutant = result.mutant
        facts = (short_place(mutant.site.span), mutant.operator)
        add_row(table, mutant.number, facts, f"{mutant.description}\n{told}", narrow=narrow)
    return table
