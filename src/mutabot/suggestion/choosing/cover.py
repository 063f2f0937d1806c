"""The fewest checks that notice as much as all of them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from itertools import combinations
from math import comb
from typing import TypeVar

C = TypeVar("C")
#: sets of checks that are looked through one by one; above it, the best is taken again and again
_SETS = 50_000


def smallest_cover(
    checks: Sequence[C], noticed: Callable[[C], frozenset[Hashable]], worth: Callable[[C], float]
) -> list[C]:
    """As few checks as possible that notice what all notice; of equal sets the one worth most.

    The fewest where that many sets can be looked through, else those that a greedy choice finds.
    """
    useful = _undominated([one for one in checks if noticed(one)], noticed, worth)
    whole: frozenset[Hashable] = frozenset().union(*map(noticed, useful)) if useful else frozenset()
    greedy = _greedy(useful, noticed, worth, whole)
    for size in range(1, len(greedy) + 1):
        if comb(len(useful), size) > _SETS:
            break
        fitting = [
            some for some in combinations(useful, size) if frozenset().union(*map(noticed, some)) == whole
        ]
        if fitting:
            return list(max(fitting, key=lambda some: sum(map(worth, some))))
    return greedy


def _undominated(
    checks: Sequence[C], noticed: Callable[[C], frozenset[Hashable]], worth: Callable[[C], float]
) -> list[C]:
    """Without those that another one can stand for: it notices more, or the same and is worth more."""
    ordered = sorted(checks, key=lambda one: (-len(noticed(one)), -worth(one)))
    kept: list[C] = []
    for one in ordered:
        if not any(noticed(one) <= noticed(other) for other in kept):
            kept.append(one)
    return kept


def _greedy(
    checks: Sequence[C],
    noticed: Callable[[C], frozenset[Hashable]],
    worth: Callable[[C], float],
    whole: frozenset[Hashable],
) -> list[C]:
    left, found = set(whole), []
    while left:
        best = max(checks, key=lambda one: (len(noticed(one) & left), worth(one)))
        found.append(best)
        left -= noticed(best)
    for one in list(found):
        others = [other for other in found if other is not one]
        if frozenset().union(*map(noticed, others)) == whole:
            found = others
    return found
