"""Suggested checks on the terminal, and the one for a mutant."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rich.console import Console
from rich.text import Text

from mutabot.report.sections import Section, plural
from mutabot.results.divergence import numbers_text
from mutabot.results.results import MutantResult
from mutabot.results.suggested import Suggestion, Suggestions, Unsolved

from .console import print_section

#: lines of a section that are shown; --json has all
_MOST = 10


def print_suggestions(console: Console, found: Suggestions) -> None:
    """Print each check with what it kills and how sure it is, the survivors that are left, and the diff."""
    killed = {mutant for one in found.suggestions for mutant in one.kills}
    survivors = plural(len(killed) + len(found.unsolved), "survivor")
    text = f"{plural(len(found.suggestions), 'check')} for {len(killed)} of {survivors}"
    console.print(Text(text, style="bold"))
    for number, one in enumerate(found.suggestions, start=1):
        print_section(console, Section(f"{number}  {one.test}", lines=[*lines_of(one, found)]))
    left = [_left(one, found) for one in found.unsolved if not one.never]
    never = [_left(one, found) for one in found.unsolved if one.never]
    dropped = [f"{one.statement}: {one.reason}" for one in found.dropped]
    sections = {
        f"No check found for {plural(len(left), 'survivor')}": left,
        f"{plural(len(never), 'survivor')} cannot be killed by any check in these tests": never,
        f"{plural(len(dropped), 'check')} dropped, because verification failed": dropped,
    }
    for name, lines in sections.items():
        if lines:
            print_section(console, Section(name, lines=lines), _MOST)
    if found.diff:
        console.print(f"\n{found.diff.rstrip()}", soft_wrap=True)


def lines_of(one: Suggestion, found: Suggestions) -> Iterator[str]:
    """Yield the assertion, what it kills, its tolerance, and its false alarms."""
    yield one.statement
    yield f"kills {_kills(one, found)}"
    seen = f"{plural(one.runs, 'run')} of the original"
    yield f"{seen} spread {one.spread:.3g}" if one.spread else f"equal in {seen}"
    yield (
        f"false alarms: none in {plural(one.fresh, 'new seed')} "
        f"(so at most {100 * one.unseen:.2g} % of runs, 95 % confidence)"
    )
    if one.by_hand:
        yield "another tool makes this test: add this by hand where it ends:"
        yield from (f"  {line}" for line in one.by_hand.splitlines())


def _kills(one: Suggestion, found: Suggestions) -> str:
    """The mutants by the rounds in which they are killed: ``#7, #9 in all rounds``."""
    by_rounds: dict[tuple[int, ...], list[int]] = {}
    for mutant, rounds in one.kills.items():
        by_rounds.setdefault(tuple(rounds), []).append(found.numbers.get(mutant, 0))
    parts = []
    for rounds, numbers in by_rounds.items():
        where = f" in {numbers_text(round + 1 for round in rounds)}"
        if len(rounds) == found.rounds:
            where = " in all rounds" if found.rounds > 1 else ""
        parts.append(", ".join(f"#{number}" for number in sorted(numbers)) + where)
    return "; ".join(parts)


def _left(one: Unsolved, found: Suggestions) -> str:
    return f"#{found.numbers.get(one.mutant, 0)} {found.descriptions.get(one.mutant, '')}: {one.reason}"


def suggested_sections(result: MutantResult, found: Suggestions | None) -> Iterator[Section]:
    """Yield the section of a survivor; nothing for other mutants."""
    if not result.is_survivor or result.mutant.ladder:
        return
    check = check_on_page(result, found)
    reasons = {one.mutant: one.reason for one in found.unsolved} if found is not None else {}
    if check is not None:
        lines = [f"in {check['test']}:", check["code"], *check["notes"]]
        lines.append("`mutabot suggest` prints it as a diff.")
    elif result.mutant.id in reasons:
        lines = [f"None was found: {reasons[result.mutant.id]}"]
    elif result.indistinguishable:
        add = "Add a probe or a test that would show one, or accept it as an equivalent mutant."
        lines = [f"No measured difference. {add}"]
    else:
        lines = [f"Run `mutabot suggest --only {result.mutant.number}` to search for a check and verify it."]
    yield Section("A check that would catch it", lines=lines)


def check_on_page(result: MutantResult, found: Suggestions | None) -> dict[str, Any] | None:
    """Return the check that was suggested for a mutant, with its notes; None if there is none."""
    suggestions = found.suggestions if found is not None else ()
    one = next((one for one in suggestions if result.mutant.id in one.kills), None)
    if one is None or found is None:
        return None
    statement, *notes = lines_of(one, found)
    return {"code": statement, "test": one.test, "notes": notes}
