"""Mutants of the second order: two mutants at once, where one and the same test reaches both."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice
from random import Random

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.model import Mutant
from mutabot.model.place import Place

#: pairs that are looked at for each one that is wanted: most do not fit where few tests share places
_LOOKED_AT = 200


def pairs(baseline: Baseline, mutants: Sequence[Mutant], limit: int, seed: int) -> list[Mutant]:
    """So many pairs of these mutants, always the same for equal seeds and mutants, in the mutants' order.

    Both belong to the same role, act at different places, and are reached by the same test in some round.
    """
    fitting = ((i, j) for i, j in _drawn(len(mutants), limit, seed) if _fit(baseline, mutants[i], mutants[j]))
    chosen = sorted(islice(fitting, limit))
    return [pair(number, mutants[i], mutants[j]) for number, (i, j) in enumerate(chosen, start=1)]


def pair(number: int, first: Mutant, second: Mutant) -> Mutant:
    """The mutant that two mutants are at once; it stands where the first one does."""
    families = dict.fromkeys((first.family, second.family))
    return replace(
        first,
        number=number,
        family="+".join(families),
        operator=f"{first.operator}+{second.operator}",
        operation="",
        pattern=None,
        quantity=None,
        variant="",
        description=f"{first.description}; {second.description}",
        idle=None,
        has_sizes=False,
        provider="+".join(dict.fromkeys((first.provider, second.provider))),
        parts=(first, second),
    )


def _drawn(size: int, limit: int, seed: int) -> Iterator[tuple[int, int]]:
    """Pairs of different indexes, each once, in random order."""
    total = size * (size - 1) // 2
    random = Random(f"{seed}:pairs")
    for number in random.sample(range(total), min(total, limit * _LOOKED_AT)):
        # the number counts 0-1, 0-2, 1-2, 0-3, 1-3, 2-3 …
        second = int((1 + (1 + 8 * number) ** 0.5) / 2)
        while second * (second - 1) // 2 > number:
            second -= 1
        yield number - second * (second - 1) // 2, second


def _fit(baseline: Baseline, first: Mutant, second: Mutant) -> bool:
    if first.site.role is not second.site.role or Place.of(first) == Place.of(second):
        return False
    both = pair(0, first, second)
    return any(baseline.judges(round, both) for round in range(len(baseline.tests)))
