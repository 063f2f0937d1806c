"""Which shard takes what: disjoint, together whole, balanced, and stable under small changes.

Every shard finds out by itself, so all that counts is the same on every machine: ids, and costs that no clock
has measured. Mutants of one function stay together, for the same tests reach them and a shard that runs none
of them need not run those; a function that is too large for that is halved, and halved again. Each piece goes
to the shard that it likes best (rendezvous hashing), if there is room (bounded loads).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from hashlib import blake2b

from mutabot.campaign.baseline.baseline import Baseline, cost
from mutabot.campaign.plan import Plan
from mutabot.campaign.request import Request
from mutabot.campaign.reuse.keys import Dependencies
from mutabot.config.options import Shard
from mutabot.frozen import frozen
from mutabot.journal.journal import Journal
from mutabot.journal.records import SHARD, ShardOf
from mutabot.model import Mutant
from mutabot.model.codec import to_data

#: a piece is at most this part of a shard, if it can be halved
_PIECES = 8
#: how much more than its part a shard takes before a piece goes elsewhere
_SLACK = 1.05
_BITS = 64


@frozen
class Item:
    """What is never parted: a mutant, or all magnitudes of a ladder.

    Attributes:
        id: its own.
        home: what it is to stay with.
        cost: more than 0, in any unit.
    """

    id: str
    home: str
    cost: float


def assign(items: Iterable[Item], shards: int) -> dict[str, int]:
    """The 0-based shard of each item, by its id."""
    items = list(items)
    total = math.fsum(item.cost for item in items)
    room = _SLACK * total / shards
    loads = [0.0] * shards
    found: dict[str, int] = {}
    # Large ones first, as they fit the worst; by classes, so that a change of cost seldom changes the order.
    for name, piece in sorted(_pieces(items, shards, total).items(), key=lambda one: _order(*one)):
        cost = math.fsum(item.cost for item in piece)
        liked = sorted(range(shards), key=lambda shard: _hash(f"{name} {shard}"))
        chosen = next((one for one in liked if loads[one] + cost <= room), None)
        if chosen is None:
            chosen = min(liked, key=lambda one: loads[one])
        loads[chosen] += cost
        found.update((item.id, chosen) for item in piece)
    return found


def _order(name: str, piece: Sequence[Item]) -> tuple[int, int]:
    return -math.frexp(math.fsum(item.cost for item in piece))[1], _hash(name)


def _pieces(items: Iterable[Item], shards: int, total: float) -> Mapping[str, list[Item]]:
    """What goes to a shard as one, by a name that says where it stands."""
    homes: dict[str, list[Item]] = {}
    for item in items:
        homes.setdefault(item.home, []).append(item)
    # a power of two: a little more or less in all does not part what was together
    limit = 2.0 ** (math.frexp(total / (shards * _PIECES))[1] - 1) if total else 0.0
    return {
        name: piece
        for home, those in homes.items()
        for name, piece in _halved(home, [(_hash(one.id), one) for one in those], limit, 0)
    }


def _halved(
    name: str, those: Sequence[tuple[int, Item]], limit: float, bit: int
) -> Iterator[tuple[str, list[Item]]]:
    if len(those) < 2 or bit == _BITS or math.fsum(item.cost for _, item in those) <= limit:
        if those:
            yield name, [item for _, item in those]
        return
    for half in (0, 1):
        yield from _halved(
            f"{name}/{half}", [one for one in those if one[0] >> bit & 1 == half], limit, bit + 1
        )


def _hash(text: str) -> int:
    return int.from_bytes(blake2b(text.encode(), digest_size=_BITS // 8).digest(), "big")


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
        depends = {**dependencies.everything, **_asked(dependencies.request)} if dependencies else None
        said = ShardOf(shard.number, shard.of, tuple(one.number for one in part.mutants), depends)
        journal.set_meta(SHARD, to_data(said))


def _asked(request: Request) -> dict[str, str]:
    """What else decides which outcomes a campaign has."""
    sample = request.sample.text if request.sample is not None else "none"
    return {"rounds": str(request.rounds), "families": ", ".join(request.families), "sample": sample}


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
