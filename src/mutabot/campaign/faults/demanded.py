"""Ladders of a plan: mutants of one graded fault at rising magnitudes, with the demanded ones added."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from mutabot.model import Mutant, Vocabulary
from mutabot.model.graded import Demand, is_same, wanted_magnitudes

if TYPE_CHECKING:
    from mutabot.faults import PlannedMutant, Project

#: graded faults, each at one site, of one quantity, in one direction: what the ids of its mutants have in
#: common, and these by rising magnitude
Ladders = Mapping[str, Sequence[Mutant]]


def split_ladders(mutants: Iterable[Mutant]) -> tuple[list[Mutant], Ladders]:
    """The mutants that stand alone, and the ladders."""
    found: dict[str, list[Mutant]] = {}
    for mutant in mutants:
        found.setdefault(mutant.ladder, []).append(mutant)
    alone = found.pop("", [])
    return alone, {name: sorted(those, key=lambda one: one.magnitude or 0.0) for name, those in found.items()}


def with_demanded(planted: Sequence[PlannedMutant], project: Project) -> list[PlannedMutant]:
    """These mutants, with one for each demanded magnitude that its ladder lacks.

    Where a family was not asked for, the ladders stay of which a demand speaks, and no others of it.
    """
    demands, families = project.demands, project.families
    if not demands:
        return [*planted]
    ladders = split_ladders(one.mutant for one in planted if one.reason is None)[1]
    wanted = demanded_of(ladders, demands, project.vocabulary)
    found = [
        one
        for one in planted
        if one.reason is not None or one.mutant.family in families or wanted.get(one.mutant.ladder)
    ]
    places = {one.mutant.ladder: one for one in reversed(found) if one.reason is None}
    for name, mutants in ladders.items():
        found += [
            replace(places[name], mutant=_at(mutants[0], size))
            for size in wanted.get(name, ())
            if not any(is_same(one.magnitude or 0.0, size) for one in mutants)
        ]
    return found


def ladders_last(planted: Sequence[PlannedMutant]) -> list[PlannedMutant]:
    """These mutants with an order by which those with sizes come last, ladder by ladder."""
    _, ladders = split_ladders(one.mutant for one in planted if one.reason is None)
    steps = [mutant.id for mutants in ladders.values() for mutant in mutants]
    order = {mutant: (1, number) for number, mutant in enumerate(steps)}
    return [
        replace(one, order=order[one.mutant.id]) if one.reason is None and one.mutant.id in order else one
        for one in planted
    ]


def demanded_of(
    ladders: Ladders, demands: Sequence[Demand], vocabulary: Vocabulary
) -> dict[str, tuple[float, ...]]:
    """The demanded magnitudes of each ladder, by its id."""
    found = {}
    for name, (first, *_) in ladders.items() if demands else ():
        quantity = vocabulary.quantity(first.operation, first.pattern, first.quantity)
        kind = quantity.kind if quantity is not None else None
        found[name] = wanted_magnitudes(demands, first, kind)
    return found


def _at(mutant: Mutant, size: float) -> Mutant:
    """Another magnitude of the same fault."""
    old, new = f"{mutant.magnitude:g}", f"{size:g}"
    before, _, behind = mutant.description.rpartition(old)
    variant = mutant.variant.removeprefix(mutant.direction)
    return replace(
        mutant,
        magnitude=size,
        variant=f"{mutant.direction}{new}{variant.removeprefix(old)}",
        description=f"{before}{new}{behind}",
    )
