"""Which shard takes what: disjoint, together whole, balanced, and stable under small changes.

Every shard finds out by itself, so all that counts is the same on every machine: ids, and costs that no clock
has measured. Each mutant, or all magnitudes of a ladder, goes to the shard that its id likes best (rendezvous
hashing), if there is room (bounded loads).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from hashlib import blake2b

from mutabot.campaign.baseline.baseline import Baseline, cost
from mutabot.campaign.plan import Plan
from mutabot.campaign.request import Request
from mutabot.campaign.reuse.keys import Dependencies
from mutabot.config.options import Shard
from mutabot.journal.journal import Journal
from mutabot.journal.records import SHARD, ShardOf
from mutabot.model import Mutant
from mutabot.model.codec import to_data

#: how much more than its part a shard takes before a piece goes elsewhere
_SLACK = 1.05


def assign(costs: Mapping[str, float], shards: int) -> dict[str, int]:
    """The 0-based shard of each item, by its id; costs are more than 0, in any unit."""
    room = _SLACK * math.fsum(costs.values()) / shards
    loads = [0.0] * shards
    found: dict[str, int] = {}
    # Large ones first, as they fit the worst; by classes, so that a change of cost seldom changes the order.
    for name, price in sorted(costs.items(), key=lambda one: (-math.frexp(one[1])[1], _hash(one[0]))):
        liked = sorted(range(shards), key=lambda shard: _hash(f"{name} {shard}"))
        chosen = next((one for one in liked if loads[one] + price <= room), None)
        found[name] = min(liked, key=lambda one: loads[one]) if chosen is None else chosen
        loads[found[name]] += price
    return found


def _hash(text: str) -> int:
    return int.from_bytes(blake2b(text.encode(), digest_size=8).digest(), "big")


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
    found = assign({name: _cost_of(those, baseline) for name, those in items.items()}, shard.of)
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
        depends = {**dependencies.everything, **_asked(dependencies.request)} if dependencies else None
        said = ShardOf(shard.number, shard.of, tuple(one.number for one in part.mutants), depends)
        journal.set_meta(SHARD, to_data(said))


def _asked(request: Request) -> dict[str, str]:
    """What else decides which outcomes a campaign has."""
    sample = request.sample.text if request.sample is not None else "none"
    return {"rounds": str(request.rounds), "families": ", ".join(request.families), "sample": sample}


def _cost_of(mutants: list[Mutant], baseline: Baseline) -> float:
    most = max(_cost(one, baseline) for one in mutants) * min(len(mutants), _SEARCH)
    # two digits: what a simulator rounds otherwise on another machine is not to part mutants otherwise
    return float(f"{most:.1e}")


def _cost(mutant: Mutant, baseline: Baseline) -> float:
    total = 0.0
    for round in range(len(baseline.tests)):
        total += _START
        for test in baseline.tests_judging(round, mutant):
            simulated, operations = cost(baseline.ends[round, test])
            total += simulated + _OPERATION * operations
    return total
