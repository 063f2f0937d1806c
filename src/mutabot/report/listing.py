"""The planned mutants on the terminal and as JSON, for ``mutabot list``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.console import Console

from mutabot.model import LeftOut, Mutant

from .as_json import mutant_data
from .console import add_number_column, make_table, plain, plural, short_place
from .terminal import left_out_lines


def print_plan(
    console: Console, mutants: Sequence[Mutant], left_out: Sequence[LeftOut], *, everything: bool = False
) -> None:
    """Print every planned mutant; ``everything`` adds ids and each mutant that was left out."""
    table = make_table()
    add_number_column(table)
    for name in ("role", "place"):
        table.add_column(name, overflow="fold")
    table.add_column("call", overflow="fold")
    table.add_column("operator", no_wrap=True)
    table.add_column("what it does", overflow="fold", ratio=1)
    for mutant in mutants:
        site = mutant.site
        place = short_place(site.span.file, site.span.line)
        description = plain(mutant.description)
        if everything:
            description += f"\n{mutant.id}"
        table.add_row(str(mutant.number), site.role.value, place, site.text, mutant.operator, description)
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
