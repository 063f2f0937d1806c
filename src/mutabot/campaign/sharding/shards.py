"""The mutants of a shard."""

from __future__ import annotations

from dataclasses import replace

from mutabot.border.codec import to_data
from mutabot.campaign.baseline.baseline import Baseline, cost
from mutabot.campaign.plan.plan import Plan
from mutabot.campaign.reuse.keys import Dependencies
from mutabot.campaign.sharding.assignment import Item, assign
from mutabot.journal.journal import Journal
from mutabot.journal.records import SHARD, ShardOf
from mutabot.model import Mutant
from mutabot.settings.options import Shard

#: what a mutant costs beside its tests, and what an operation costs, in simulated seconds: the clock on the
#: wall shows something else on each machine; and how many magnitudes a ladder runs, about
_START, _OPERATION, _SEARCH = 0.1, 0.01, 4


def part_of(plan: Plan, shard: Shard | None, baseline: Baseline) -> Plan:
    """What a shard runs of a plan; all of it without a shard."""
    if shard is None:
        return plan
    items: dict[str, list[Mutant]] = {}
    for mutant in plan.mutants:
        items.setdefault(mutant.ladder or mutant.id, []).append(mutant)
    found = assign((_item(name, those, baseline) for name, those in items.items()), shard.of)
    own = {name for name, number in found.items() if number == shard.number - 1}
    return replace(plan, mutants=[one for one in plan.mutants if (one.ladder or one.id) in own])


def write_shard(
    journal: Journal, shard: Shard | None, part: Plan, dependencies: Dependencies | None = None
) -> None:
    """Write down which part of the plan is run; nothing without a shard.

    Args:
        part: its mutants.
        dependencies: None if they are not known yet, or files change.
    """
    if shard is not None:
        depends = dict(dependencies.everything) if dependencies is not None else None
        said = ShardOf(shard.number, shard.of, tuple(one.number for one in part.mutants), depends)
        journal.set_meta(SHARD, to_data(said))


def _item(name: str, mutants: list[Mutant], baseline: Baseline) -> Item:
    span = mutants[0].site.span
    most = max(_cost(one, baseline) for one in mutants) * min(len(mutants), _SEARCH)
    # two digits: what a simulator rounds otherwise on another machine is not to part mutants otherwise
    return Item(name, f"{span.file}:{span.function}", float(f"{most:.1e}"))


def _cost(mutant: Mutant, baseline: Baseline) -> float:
    total = 0.0
    for round in range(len(baseline.tests)):
        total += _START
        for test in baseline.tests_judging(round, mutant):
            simulated, operations = cost(baseline.ends[round, test])
            total += simulated + _OPERATION * operations
    return total
