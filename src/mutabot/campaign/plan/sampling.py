"""Drawing some of the selected mutants at random: a sample, or one per site.

What is drawn depends on the campaign's seed and the mutants' ids alone, so it is the same on every machine; a
new mutant elsewhere takes the place of one other at most, and a larger sample holds the smaller one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from hashlib import blake2b

from mutabot.journal.records import Drawing, Stratum
from mutabot.model import Mutant
from mutabot.settings.sample import Sample


def draw(
    mutants: Sequence[Mutant], seed: int, *, sample: Sample | None = None, one_per_site: bool = False
) -> tuple[list[Mutant], Drawing]:
    """The mutants to run, in their order and with their numbers, and how they were drawn."""
    left = _one_per_site(mutants, seed) if one_per_site else list(mutants)
    strata = _strata(left)
    drawn = _sampled(strata, seed, sample) if sample is not None else {mutant.id for mutant in left}
    described = (
        Stratum(family, role, len(those), sum(one.id in drawn for one in those))
        for (family, role), those in strata.items()
    )
    drawing = Drawing(sample.text if sample else None, one_per_site, len(mutants), tuple(described))
    return [mutant for mutant in left if mutant.id in drawn], drawing


def _one_per_site(mutants: Sequence[Mutant], seed: int) -> list[Mutant]:
    """One of each family at each site: families do not take places from one another."""
    chosen: dict[tuple[str, object], Mutant] = {}
    for mutant in _shuffled(mutants, f"{seed}:site"):
        chosen.setdefault((mutant.family, mutant.site), mutant)
    ids = {mutant.id for mutant in chosen.values()}
    return [mutant for mutant in mutants if mutant.id in ids]


def _sampled(strata: Mapping[tuple[str, str], Sequence[Mutant]], seed: int, sample: Sample) -> set[str]:
    return {
        mutant.id
        for family in dict.fromkeys(family for family, _ in strata)
        for mutant in _sampled_of_family(
            {role: those for (name, role), those in strata.items() if name == family}, seed, sample
        )
    }


def _sampled_of_family(roles: Mapping[str, Sequence[Mutant]], seed: int, sample: Sample) -> Iterator[Mutant]:
    sizes = sample.sizes({role: len(those) for role, those in roles.items()})
    for role, those in roles.items():
        yield from _shuffled(those, f"{seed}:sample")[: sizes[role]]


def _strata(mutants: Iterable[Mutant]) -> dict[tuple[str, str], list[Mutant]]:
    strata: dict[tuple[str, str], list[Mutant]] = {}
    for mutant in mutants:
        strata.setdefault((mutant.family, mutant.site.role.value), []).append(mutant)
    return strata


def _shuffled(mutants: Iterable[Mutant], salt: str) -> list[Mutant]:
    """In an order that each mutant's place depends on by its own id only."""
    return sorted(mutants, key=lambda one: blake2b(f"{salt}:{one.id}".encode(), digest_size=16).digest())
