"""The planned mutants on the terminal and as JSON, for ``mutabot list``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.console import Console

from mutabot.model import LeftOut, Mutant
from mutabot.report.as_json import mutant_data

from .campaign import WIDE, left_out_lines
from .console import add_row, make_mutant_table, plural, short_place


def print_plan(
    console: Console, mutants: Sequence[Mutant], left_out: Sequence[LeftOut], *, everything: bool = False
) -> None:
    """Print every planned mutant; ``everything`` adds ids and each mutant that was left out."""
    narrow = console.width < WIDE
    table = make_mutant_table(("role", "place", "operator", "quantity"), "what it does", narrow=narrow)
    for mutant in mutants:
        site = mutant.site
        quantity = "/".join(part for part in (mutant.pattern_name, mutant.quantity) if part) or "–"
        place = short_place(site.span.file, site.span.line)
        text = f"{mutant.description}\n{mutant.id}" if everything else mutant.description
        facts = (site.role.value, place, mutant.operator, quantity)
        add_row(table, mutant.number, facts, text, narrow=narrow)
    console.print(table)
    console.print(plural(len(mutants), "mutant"))
    for line in left_out_lines(left_out, everything=everything):
        console.print(line)


def plan_data(mutants: Sequence[Mutant], left_out: Sequence[LeftOut]) -> dict[str, Any]:
    """The plan as JSON-like data."""
    return {
        "mutants": [mutant_data(mutant) for mutant in mutants],
        "left_out": [
            {"id": item.id, "description": item.description, "reason": item.reason} for item in left_out
        ],
    }
