"""Shards are disjoint, together whole, balanced, and stable under small edits."""

from __future__ import annotations

import random
from collections import Counter

import pytest

from mutabot.campaign.sharding.shards import assign

SIZES = ((60, 4), (400, 8), (1500, 16))


def costs_of(number: int, seed: int) -> dict[str, float]:
    """Mutants of functions whose tests cost very differently."""
    chance = random.Random(seed)
    found: dict[str, float] = {}
    while len(found) < number:
        home, price = f"f{len(found)}", 0.1 + round(chance.lognormvariate(0.0, 0.7), 1)
        size = 1 + int(chance.lognormvariate(2.2, 1.0))
        found |= {f"{home}:{at}": price * chance.choice((0.5, 1, 2)) for at in range(size)}
    return dict(list(found.items())[:number])


@pytest.mark.parametrize(("number", "shards"), SIZES)
@pytest.mark.parametrize("seed", range(3))
def test_every_item_is_in_one_shard_and_no_shard_is_much_larger(number: int, shards: int, seed: int) -> None:
    costs = costs_of(number, seed)
    found = assign(costs, shards)
    assert found.keys() == costs.keys()
    loads: Counter[int] = Counter()
    for name, shard in found.items():
        loads[shard] += round(1000 * costs[name])
    assert set(found.values()) == set(range(shards))
    assert max(loads.values()) <= 1.06 * sum(loads.values()) / shards


def test_the_order_of_the_items_does_not_count() -> None:
    costs = costs_of(400, 1)
    assert assign(costs, 8) == assign(dict(reversed(costs.items())), 8)


@pytest.mark.parametrize(("number", "shards"), SIZES[1:])
def test_one_item_more_or_less_moves_few_others(number: int, shards: int) -> None:
    moved = []
    for seed in range(4):
        costs = costs_of(number, seed)
        before = assign(costs, shards)
        for gone in random.Random(seed).sample(sorted(costs), 5):
            after = assign({name: cost for name, cost in costs.items() if name != gone}, shards)
            moved.append(sum(before[name] != shard for name, shard in after.items()) / number)
    assert sum(moved) / len(moved) < 0.04


def test_fewer_items_than_shards_leave_some_empty() -> None:
    assert len(set(assign(costs_of(3, 0), 8).values())) == 3
    assert assign({}, 4) == {}
