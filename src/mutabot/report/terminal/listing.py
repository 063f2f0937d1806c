"""The planned mutants and the operators on the terminal: ``mutabot list`` and ``operators``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Any

from rich.console import Console
from rich.text import Text

from mutabot.model import LeftOut, Mutant
from mutabot.report.document import data_of
from mutabot.report.sections import Section, plural, skipped

from .console import below, heading, print_section, short_place


def print_plan(
    console: Console, mutants: Sequence[Mutant], left_out: Sequence[LeftOut], *, everything: bool = False
) -> None:
    """Print every planned mutant, a ladder in one line; ``everything`` adds ids and all that was left out."""
    ladders = len({mutant.ladder for mutant in mutants} - {""})
    of_them = f" ({plural(ladders, 'ladder')} in one line each)" if ladders and not everything else ""
    rows = [
        (
            str(mutant.number),
            mutant.site.role.value,
            short_place(mutant.site.span),
            mutant.operator,
            f"{mutant.description}\n{mutant.id}" if everything else mutant.description,
        )
        for mutant in (mutants if everything else _ladders_in_one(mutants))
    ]
    columns = (">no.", "role", "place", "operator", "*fault")
    print_section(console, Section(f"{plural(len(mutants), 'mutant')}{of_them}", columns, rows))
    if left_out:
        print_section(console, skipped(left_out))
    for item in left_out if everything else ():
        console.print(below(f"{item.id}  {item.description}: {item.reason}"))


def _ladders_in_one(mutants: Sequence[Mutant]) -> list[Mutant]:
    """The mutants, with the first of each ladder for all of its magnitudes."""
    ladders: dict[str, list[Mutant]] = {}
    for mutant in mutants:
        ladders.setdefault(mutant.ladder or mutant.id, []).append(mutant)
    return [steps[0] if len(steps) == 1 else _ladder(steps) for steps in ladders.values()]


def _ladder(steps: Sequence[Mutant]) -> Mutant:
    first = steps[0]
    before, _, behind = first.description.rpartition(f"{first.magnitude:g}")
    sizes = ", ".join(f"{one.magnitude:g}" for one in steps)
    return replace(first, description=f"{before}{sizes}{behind}")


def plan_data(mutants: Sequence[Mutant], left_out: Sequence[LeftOut]) -> dict[str, Any]:
    """Return the plan as JSON-like data."""
    return {"mutants": data_of(mutants), "left_out": data_of(left_out)}


def print_rules(console: Console, rules: Iterable[Mapping[str, str]]) -> None:
    """Print operators, family by family: what each does, where it applies, and its source."""
    found = list(rules)
    for family, group in groupby(found, key=lambda rule: rule["family"]):
        console.print(heading(family))
        for rule in group:
            console.print(Text(rule["name"], style="bold"))
            more = [f"{name}: {rule[name]}" for name in ("where", "source") if rule[name]]
            for line in (rule["summary"], *more):
                console.print(below(line, 3))
    console.print(f"\n{plural(len(found), 'operator')}")
