"""Magnitudes that are demanded join the ladders of a plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from mutabot.families import GRADED
from mutabot.model import Kind, Mutant, Vocabulary
from mutabot.model.graded.demand import Demand, is_same, wanted_magnitudes

from .ladders import Ladder, apart
from .planned import Plan


def with_demanded(
    plan: Plan, demands: Sequence[Demand], vocabulary: Vocabulary, families: Sequence[str]
) -> Plan:
    """The plan with a mutant for each demanded magnitude that its ladder lacks.

    Where graded mutants were not asked for, the ladders stay of which a demand speaks, and no others.
    """
    if not demands:
        return plan
    wanted = _wanted(apart(plan.mutants)[1], demands, vocabulary)
    mutants = [one for one in plan.mutants if GRADED in families or not one.ladder or wanted.get(one.ladder)]
    for ladder in apart(mutants)[1]:
        mutants += [
            _at(ladder.mutants[0], size)
            for size in wanted.get(ladder.id, ())
            if not any(is_same(one.magnitude or 0.0, size) for one in ladder.mutants)
        ]
    return replace(plan, mutants=mutants)


def ladders_last(plan: Plan) -> Plan:
    """The plan with graded mutants behind all others, whose numbers are the same with and without them."""
    alone, ladders = apart(plan.mutants)
    mutants = [*alone, *(mutant for ladder in ladders for mutant in ladder.mutants)]
    return replace(plan, mutants=[replace(one, number=at) for at, one in enumerate(mutants, start=1)])


def demanded_of(
    ladders: Sequence[Ladder], demands: Sequence[Demand], vocabulary: Vocabulary
) -> Mapping[str, tuple[float, ...]]:
    """The demanded magnitudes of each ladder, by its id."""
    return _wanted(ladders, demands, vocabulary) if demands else {}


def _wanted(
    ladders: Sequence[Ladder], demands: Sequence[Demand], vocabulary: Vocabulary
) -> dict[str, tuple[float, ...]]:
    kinds = {one.id: _kind_of(one.mutants[0], vocabulary) for one in ladders}
    return {one.id: wanted_magnitudes(demands, one.mutants[0], kinds[one.id]) for one in ladders}


def _kind_of(mutant: Mutant, vocabulary: Vocabulary) -> Kind | None:
    operation = vocabulary.operation(mutant.operation)
    if operation is None:
        return None
    pattern = operation.pattern(mutant.pattern)
    meant = pattern if pattern is not None else operation
    quantities = (*meant.arguments, *meant.result)
    return next((one.kind for one in quantities if one.name == mutant.quantity), None)


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
