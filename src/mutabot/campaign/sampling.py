"""Drawing some of the selected mutants at random: a sample, or one per site.

What is drawn depends on the campaign's seed and the mutants' ids alone, so it is the same on every machine; a
new mutant elsewhere takes the place of one other at most, and a larger sample holds the smaller one.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_HALF_UP, Decimal
from hashlib import blake2b

from mutabot.errors import UsageError
from mutabot.model import Mutant

#: key of the journal's meta
DRAWING = "drawing"
_SHARE = re.compile(r"([0-9]{1,9}(?:\.[0-9]{1,9})?)\s*%")
_COUNT = re.compile(r"[0-9]{1,9}")


@dataclass(frozen=True, slots=True)
class Sample:
    """How many mutants to draw: a share of each family and role, or a number of each family.

    Attributes:
        text: as the user wrote it.
        percent: more than 0, at most 100; None if a number was given.
        count: at least 1; None if a share was given.
    """

    text: str
    percent: Decimal | None = None
    count: int | None = None

    @classmethod
    def parse(cls, text: str) -> Sample:
        """What ``10%``, ``12.5 %`` or ``50`` says. Raises UsageError for anything else."""
        plain = text.strip()
        share, count = _SHARE.fullmatch(plain), _COUNT.fullmatch(plain)
        if share is not None:
            percent = Decimal(share[1])
            if 0 < percent <= 100:
                return cls(plain, percent=percent)
            raise UsageError(f"a sample of {plain} cannot be drawn: a share is above 0 and at most 100 %")
        if count is not None:
            if int(plain) > 0:
                return cls(plain, count=int(plain))
            raise UsageError("a sample of 0 mutants says nothing: draw at least 1")
        raise UsageError(f"{text!r} is no size of a sample; write a share such as 10% or a number such as 50")

    def sizes(self, roles: Mapping[str, int]) -> dict[str, int]:
        """How many to draw of each role of one family, given how many there are.

        A number is divided as the mutants are; no role goes away empty while there is enough for all.
        """
        if self.percent is not None:
            return {role: max(1, _rounded(self.percent * count / 100)) for role, count in roles.items()}
        assert self.count is not None
        total = sum(roles.values())
        wanted = min(self.count, total)
        sizes = {role: wanted * count // total for role, count in roles.items()}
        by_remainder = sorted(roles, key=lambda role: wanted * roles[role] % total, reverse=True)
        for role in by_remainder[: wanted - sum(sizes.values())]:
            sizes[role] += 1
        for role in [role for role, size in sizes.items() if size == 0]:
            richest = max(sizes, key=lambda one: sizes[one])
            if sizes[richest] > 1:
                sizes[richest] -= 1
                sizes[role] += 1
        return sizes


@dataclass(frozen=True, slots=True)
class Stratum:
    """The mutants of one family in one role, of which some were drawn.

    Attributes:
        family, role: which.
        population: how many there were.
        drawn: how many were drawn.
    """

    family: str
    role: str
    population: int
    drawn: int


@dataclass(frozen=True, slots=True)
class Drawing:
    """How the mutants of a campaign were drawn from the selected ones.

    Attributes:
        sample: the size that was asked for; None for all.
        one_per_site: whether one mutant per site was drawn before; the sample is of those.
        selected: how many mutants there were before anything was drawn.
        strata: one per family and role; the population is what the sample was drawn from.
    """

    sample: str | None
    one_per_site: bool
    selected: int
    strata: tuple[Stratum, ...]

    def stratum(self, family: str, role: str) -> Stratum | None:
        """That of a family in a role."""
        return next((one for one in self.strata if (one.family, one.role) == (family, role)), None)


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


def _rounded(number: Decimal) -> int:
    return int(number.quantize(Decimal(1), rounding=ROUND_HALF_UP))
