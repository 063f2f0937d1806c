"""Ladders in a plan: mutants of one graded fault at rising magnitudes, and demanded ones."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from mutabot.model import Mutant, Vocabulary
from mutabot.thresholds.demands import Demand, wanted_magnitudes

#: graded faults, each at one site, of one quantity, in one direction: what the ids of its mutants have in
#: common, and these by rising magnitude
Ladders = Mapping[str, Sequence[Mutant]]


def split_ladders(mutants: Iterable[Mutant]) -> tuple[list[Mutant], Ladders]:
    """Split mutants into those without magnitudes, and ladders."""
    found: dict[str, list[Mutant]] = {}
    for mutant in mutants:
        found.setdefault(mutant.ladder, []).append(mutant)
    alone = found.pop("", [])
    return alone, {
        name: sorted(those, key=lambda member: member.magnitude or 0.0) for name, those in found.items()
    }


def demanded_of(
    ladders: Ladders, demands: Sequence[Demand], vocabulary: Vocabulary
) -> dict[str, tuple[float, ...]]:
    """Return the demanded magnitudes of each ladder, by its id."""
    found = {}
    for name, (first, *_) in ladders.items() if demands else ():
        quantity = vocabulary.quantity(first.operation, first.pattern, first.quantity)
        kind = quantity.kind if quantity is not None else None
        found[name] = wanted_magnitudes(demands, first, kind)
    return found


def at_magnitude(mutant: Mutant, size: float) -> Mutant:
    """Return the fault at another magnitude."""
    old, new = f"{mutant.magnitude:g}", f"{size:g}"
    before, found, behind = mutant.description.rpartition(old)
    if not found:  # it does not say how large the fault is
        before, behind = f"{mutant.description}, ", ""
    variant = mutant.variant.removeprefix(mutant.direction)
    return replace(
        mutant,
        magnitude=size,
        variant=f"{mutant.direction}{new}{variant.removeprefix(old)}",
        description=f"{before}{new}{behind}",
    )
