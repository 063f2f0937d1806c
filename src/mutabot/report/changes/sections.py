"""The sections in which every report tells what differs: a heading, and the mutants below it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from mutabot.analysis.results import MutantResult
from mutabot.analysis.score import Group
from mutabot.analysis.stored.changes import Changes, Pair
from mutabot.report.shaping.status import rounds_text


@dataclass(frozen=True, slots=True)
class Section:
    """Mutants of which the same is to be said.

    Attributes:
        heading: what is said, with a capital letter.
        rows: the mutants, each with what happened to it.
    """

    heading: str
    rows: tuple[tuple[MutantResult, str], ...]


def sections(changes: Changes) -> Iterator[Section]:
    """The sections that are not empty, what needs action first."""
    pairs = (
        ("New survivors", changes.appeared),
        ("Changed survivors", changes.changed),
        ("Survivors of which nothing is known now", changes.unknown),
        ("Fixed survivors", changes.fixed),
    )
    for heading, found in pairs:
        if found:
            yield Section(heading, tuple((pair.either, _told(pair)) for pair in found))
    if changes.gone:
        yield Section(
            "Mutants that are gone", tuple((one, f"before: {rounds_text(one)}") for one in changes.gone)
        )
    added = tuple((one, rounds_text(one)) for one in changes.added if not one.is_survivor)
    if added:
        yield Section("New mutants that do not survive", added)


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
        yield f"{family} · {role}", _percent(before), _percent(after), by


def _told(pair: Pair) -> str:
    old = f"before: {rounds_text(pair.old)}" if pair.old is not None else "a new mutant"
    return f"{rounds_text(pair.new)}; {old}" if pair.new is not None else old


def _mean(group: Group | None) -> float | None:
    return group.scores.mean if group is not None else None


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.1f} %"
