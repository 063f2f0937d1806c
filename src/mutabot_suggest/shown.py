"""Suggestions as the command shows them: on the terminal, and as JSON."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.text import Text

from mutabot.report.document import data_of
from mutabot.report.sections import Section, plural, suggestion_lines
from mutabot.report.terminal.console import print_section
from mutabot.results.suggested import Suggestion, Suggestions, Unsolved

#: lines of a section that are shown; --json has all
_MOST = 10


def print_suggestions(console: Console, found: Suggestions) -> None:
    """Print each check with what it kills and how sure it is, the survivors that are left, and the diff."""
    killed = {mutant for one in found.suggestions for mutant in one.kills}
    survivors = plural(len(killed) + len(found.unsolved), "survivor")
    text = f"{plural(len(found.suggestions), 'check')} for {len(killed)} of {survivors}"
    console.print(Text(text, style="bold"))
    for number, one in enumerate(found.suggestions, start=1):
        print_section(console, Section(f"{number}  {one.test}", lines=[*suggestion_lines(one, found)]))
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


def _left(one: Unsolved, found: Suggestions) -> str:
    return f"#{found.numbers.get(one.mutant, 0)} {found.descriptions.get(one.mutant, '')}: {one.reason}"


def data_of_suggestions(found: Suggestions) -> dict[str, Any]:
    """Return what ``--json`` prints; docs/suggest.md describes it."""

    def mutant(name: str) -> dict[str, Any]:
        told = found.descriptions.get(name, "")
        return {"id": name, "number": found.numbers.get(name), "description": told}

    def kills(one: Suggestion) -> list[dict[str, Any]]:
        return [
            {"mutant": mutant(name), "rounds": [round + 1 for round in rounds]}
            for name, rounds in one.kills.items()
        ]

    return {
        **data_of.facts(found, "rounds seeds"),
        "suggestions": [{**data_of(one), "kills": kills(one)} for one in found.suggestions],
        "diff": found.diff,
        "unsolved": [{**data_of(one), "mutant": mutant(one.mutant)} for one in found.unsolved],
        "dropped": data_of(found.dropped),
    }
