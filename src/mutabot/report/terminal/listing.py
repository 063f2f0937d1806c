"""The planned mutants on the terminal and as JSON, and the operators: ``mutabot list`` and ``operators``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Any

from rich.console import Console
from rich.padding import Padding
from rich.text import Text

from mutabot.model import LeftOut, Mutant
from mutabot.report.document import data_of
from mutabot.report.terminal.campaign import WIDE, left_out_lines
from mutabot.report.terminal.console import add_row, heading, make_mutant_table, plain, plural, short_place


def print_plan(
    console: Console, mutants: Sequence[Mutant], left_out: Sequence[LeftOut], *, everything: bool = False
) -> None:
    """Print every planned mutant, a ladder in one line; ``everything`` adds ids and all that was left out."""
    narrow = console.width < WIDE
    table = make_mutant_table(("role", "place", "operator", "quantity"), "what it does", narrow=narrow)
    shown = list(mutants) if everything else _ladders_in_one(mutants)
    for mutant in shown:
        site = mutant.site
        quantity = "/".join(part for part in (mutant.pattern_name, mutant.quantity) if part) or "–"
        place = short_place(site.span)
        text = f"{mutant.description}\n{mutant.id}" if everything else mutant.description
        facts = (site.role.value, place, mutant.operator, quantity)
        add_row(table, mutant.number, facts, text, narrow=narrow)
    console.print(table)
    ladders = len({mutant.ladder for mutant in mutants} - {""})
    of_them = f" ({plural(ladders, 'ladder')} in one line each)" if ladders and not everything else ""
    console.print(f"{plural(len(mutants), 'mutant')}{of_them}")
    for line in left_out_lines(left_out, everything=everything):
        console.print(line)


def _ladders_in_one(mutants: Sequence[Mutant]) -> list[Mutant]:
    """The mutants, with the first of each ladder for all of its magnitudes."""
    ladders: dict[str, list[Mutant]] = {}
    for mutant in mutants:
        if mutant.ladder:
            ladders.setdefault(mutant.ladder, []).append(mutant)
    found = []
    for mutant in mutants:
        steps = ladders.get(mutant.ladder, [])
        if not steps:
            found.append(mutant)
        elif steps[0] is mutant:
            found.append(replace(mutant, description=_ladder_text(steps)))
    return found


def _ladder_text(steps: Sequence[Mutant]) -> str:
    """What a ladder does: the words of its first step, with all magnitudes."""
    first = steps[0]
    before, _, behind = first.description.rpartition(f"{first.magnitude:g}")
    return f"{before}{', '.join(f'{one.magnitude:g}' for one in steps)}{behind}"


def plan_data(mutants: Sequence[Mutant], left_out: Sequence[LeftOut]) -> dict[str, Any]:
    """The plan as JSON-like data."""
    return {"mutants": data_of(mutants), "left_out": data_of(left_out)}


def print_rules(console: Console, rules: Iterable[Mapping[str, str]]) -> None:
    """Print operators, family by family: what each does, where it applies, and what it stands for."""
    found = list(rules)
    for family, group in groupby(found, key=lambda rule: rule["family"]):
        console.print(heading(family))
        for rule in group:
            console.print(Text(rule["name"], style="bold"))
            for line in _lines(rule):
                console.print(Padding(Text(plain(line), overflow="fold"), (0, 0, 0, 3), expand=False))
    console.print()
    console.print(plural(len(found), "operator"))


def _lines(rule: Mapping[str, str]) -> Iterable[str]:
    yield rule["summary"]
    if rule["where"]:
        yield f"where: {rule['where']}"
    if rule["source"]:
        yield f"source: {rule['source']}"
