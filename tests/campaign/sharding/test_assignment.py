"""Shards are disjoint, together whole, balanced, and stable under small edits."""

from __future__ import annotations

import random
from collections import Counter, defaultdict

import pytest

from mutabot.campaign.sharding.shards import Item, assign

SIZES = ((60, 4), (400, 8), (1500, 16))


def items_of(number: int, seed: int) -> list[Item]:
    """Functions of very different sizes, whose tests cost very differently."""
    chance = random.Random(seed)
    found: list[Item] = []
    while len(found) < number:
        home, price = f"f{len(found)}", 0.1 + round(chance.lognormvariate(0.0, 0.7), 1)
        size = 1 + int(chance.lognormvariate(2.2, 1.0))
        found += [Item(f"{home}:{at}", home, price * chance.choice((0.5, 1, 2))) for at in range(size)]
    return found[:number]


def loads_of(items: list[Item], found: dict[str, int]) -> Counter[int]:
    loads: Counter[int] = Counter()
    for item in items:
        loads[found[item.id]] += round(1000 * item.cost)
    return loads


@pytest.mark.parametrize(("number", "shards"), SIZES)
@pytest.mark.parametrize("seed", range(3))
def test_every_item_is_in_one_shard_and_no_shard_is_much_larger(number: int, shards: int, seed: int) -> None:
    items = items_of(number, seed)
    found = assign(items, shards)
    assert found.keys() == {item.id for item in items}
    loads = loads_of(items, found)
    mean = sum(loads.values()) / shards
    assert set(found.values()) == set(range(shards))
    assert max(loads.values()) <= 1.06 * mean


def test_the_order_of_the_items_does_not_count() -> None:
    items = items_of(400, 1)
    assert assign(items, 8) == assign(items[::-1], 8)


@pytest.mark.parametrize(("number", "shards"), SIZES[1:])
def test_one_item_more_or_less_moves_few_others(number: int, shards: int) -> None:
    moved = []
    for seed in range(4):
        items = items_of(number, seed)
        before = assign(items, shards)
        for gone in random.Random(seed).sample(items, 5):
            after = assign([item for item in items if item is not gone], shards)
            moved.append(sum(before[name] != shard for name, shard in after.items()) / number)
    assert sum(moved) / len(moved) < 0.04


def test_a_function_that_is_renamed_moves_few_mutants_of_others() -> None:
    items = items_of(1500, 2)
    home = items[700].home
    before = assign(items, 8)
    after = assign([Item(f"new:{one.id}", "new", one.cost) if one.home == home else one for one in items], 8)
    assert sum(after.get(name, shard) != shard for name, shard in before.items()) < 0.1 * len(items)


def test_small_functions_stay_in_one_shard() -> None:
    items = items_of(1500, 3)
    found = assign(items, 4)
    shards: dict[str, set[int]] = defaultdict(set)
    for item in items:
        shards[item.home].add(found[item.id])
    assert sum(map(len, shards.values())) < 1.2 * len(shards)


def test_a_large_function_is_parted() -> None:
    found = assign([Item(f"m{at}", "all", 1.0) for at in range(800)], 8)
    assert max(Counter(found.values()).values()) <= 106


def test_fewer_items_than_shards_leave_some_empty() -> None:
    assert len(set(assign(items_of(3, 0), 8).values())) == 3
    assert assign([], 4) == {}
