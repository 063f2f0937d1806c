"""What differs between two campaigns, on the terminal and as Markdown, in the same sections."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from rich.console import Console
from rich.text import Text

from mutabot.analysis.results import MutantResult
from mutabot.analysis.score import Group
from mutabot.analysis.stored import Changes, Ends

from .terminal.console import heading, make_table, percent, plain, short_place
from .texts import escaped, rounds_text, table

#: a heading, and the mutants of which it is said, each with what happened to it
Section = tuple[str, tuple[tuple[MutantResult, str], ...]]


def sections(changes: Changes) -> Iterator[Section]:
    """The sections that are not empty, what needs action first."""
    pairs = (
        ("New survivors", changes.appeared),
        ("Changed survivors", changes.changed),
        ("Survivors with unknown state now", changes.unknown),
        ("Fixed survivors", changes.fixed),
        ("Removed mutants", changes.gone),
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
    """Yield the lines of Markdown. ``path`` names a file of the project as the reader knows it."""
    yield from ("### Since the older campaign", "", f"{summary(changes)}.", "")
    for line in notes(changes):
        yield from (f"> **{escaped(line)}**", "")
    yield from table(("family · role", "old", "new", "points"), score_rows(changes), right=(1, 2, 3))
    for title, found in sections(changes):
        yield from (f"#### {title}: {len(found)}", "")
        rows = []
        for result, told in found[:_ROWS]:
            mutant, span = result.mutant, result.mutant.site.span
            place = replace(span, file=path(span.file)).place
            rows.append((str(mutant.number), place, mutant.operator, mutant.description, told))
        yield from table(("no.", "place", "operator", "fault", "result"), rows, right=(0,))
        if len(found) > _ROWS:
            yield from (f"and {len(found) - _ROWS} more", "")


def print_changes(console: Console, changes: Changes) -> None:
    """Print what differs."""
    console.print(Text(summary(changes), style="bold"))
    for line in notes(changes):
        console.print(Text(plain(line), style="bold"))
    scores = make_table(("family · role", ">old", ">new", ">points"))
    for row in score_rows(changes):
        scores.add_row(*row)
    console.print(scores)
    for title, found in sections(changes):
        console.print(heading(f"{title}: {len(found)}"))
        mutants = make_table((">no.", "place", "operator", "*fault and result"))
        for result, told in found[:_ROWS]:
            mutant = result.mutant
            text = plain(f"{mutant.description}\n{told}")
            mutants.add_row(str(mutant.number), short_place(mutant.site.span), mutant.operator, text)
        console.print(mutants)
        if len(found) > _ROWS:
            console.print(Text(f"and {len(found) - _ROWS} more", style="dim"))
