"""What differs between two campaigns, in the same sections on the terminal and as Markdown."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from rich.console import Console
from rich.text import Text

from mutabot.model import Span
from mutabot.results.score import Group
from mutabot.results.stored import Changes, Ends

from .sections import Section, percent, section_lines
from .terminal.console import plain, print_section, short_place
from .texts import escaped, rounds_text

#: mutants of a section that are shown
_ROWS = 50


def sections(changes: Changes, place: Callable[[Span], str]) -> Iterator[Section]:
    """Yield the scores, then the sections that are not empty, what needs action first."""
    yield Section("Scores", ("family · role", ">old", ">new", ">points"), [*_score_rows(changes)])
    pairs: tuple[tuple[str, Sequence[Ends]], ...] = (
        ("New survivors", changes.appeared),
        ("Changed survivors", changes.changed),
        ("Survivors with unknown state now", changes.unknown),
        ("Fixed survivors", changes.fixed),
        ("Removed mutants", changes.gone),
        ("New mutants that do not survive", [one for one in changes.added if not one.either.is_survivor]),
    )
    for name, found in pairs:
        rows = [_row(pair, place) for pair in found]
        if rows:
            yield Section(f"{name}: {len(rows)}", (">no.", "place", "operator", "*fault", "*result"), rows)


def _row(pair: Ends, place: Callable[[Span], str]) -> tuple[str, ...]:
    mutant = pair.either.mutant
    told = rounds_text(pair.either)
    if pair.new is not None and pair.old is not None:
        told = f"{told}; before: {rounds_text(pair.old)}"
    elif pair.new is None:
        told = f"before: {told}"
    return str(mutant.number), place(mutant.site.span), mutant.operator, mutant.description, told


def summary(changes: Changes) -> str:
    """Return the numbers in a line."""
    return (
        f"Survivors: {len(changes.appeared)} new, {len(changes.fixed)} fixed, "
        f"{len(changes.changed)} changed, {changes.same} as before, {len(changes.unknown)} unknown; "
        f"mutants: {len(changes.added)} new, {len(changes.gone)} removed"
    )


def notes(changes: Changes) -> list[str]:
    """Return what to know about campaigns that did not run to their end, or not of the same mutants."""
    states = (("old", changes.old_state), ("new", changes.new_state))
    ends = [f"the {name} campaign is not complete: {state}" for name, state in states if state != "complete"]
    return [*ends, *changes.notes]


def _score_rows(changes: Changes) -> Iterator[tuple[str, str, str, str]]:
    """Family and role, the old score, the new one, and the difference in percentage points."""
    for (family, role), (old, new) in changes.scores.items():
        before, after = _mean(old), _mean(new)
        by = f"{100 * (after - before):+.1f}" if before is not None and after is not None else "–"
        yield f"{family} · {role}", percent(before), percent(after), by


def _mean(group: Group | None) -> float | None:
    return group.scores.mean if group is not None else None


def change_lines(changes: Changes, place: Callable[[Span], str]) -> Iterator[str]:
    """Yield the lines of Markdown. ``place`` names a span as the reader knows it."""
    yield from ("### Since the older campaign", "", f"{summary(changes)}.", "")
    for line in notes(changes):
        yield from (f"> **{escaped(line)}**", "")
    for section in sections(changes, place):
        yield from section_lines(section, _ROWS, level=4)


def print_changes(console: Console, changes: Changes) -> None:
    """Print what differs."""
    for line in (summary(changes), *notes(changes)):
        console.print(Text(plain(line), style="bold"))
    for section in sections(changes, short_place):
        print_section(console, section, _ROWS)
