"""The plan: the mutants of all providers that are asked for, with their numbers, or a random sample of them.

What is drawn depends on the campaign's seed and the mutants' ids alone, so it is the same on every machine; a
new mutant elsewhere takes the place of one other at most, and a larger sample holds the smaller one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from hashlib import blake2b
from itertools import groupby

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.faults.providers import asked_for
from mutabot.faults import Preparation, Project
from mutabot.frozen import frozen
from mutabot.journal.records import Drawing, Stratum
from mutabot.model import LeftOut, Mutant
from mutabot.settings.options import Sample


@frozen
class Plan:
    """Mutants to run, and what is left out.

    Attributes:
        drawing: how the mutants were drawn from the selected ones; None if all of these are there.
    """

    mutants: list[Mutant]
    left_out: list[LeftOut]
    drawing: Drawing | None = None


def draw(mutants: Sequence[Mutant], seed: int, sample: Sample) -> tuple[list[Mutant], Drawing]:
    """The mutants to run, in their order and with their numbers, and how they were drawn."""
    strata = _strata(mutants)
    drawn = _sampled(strata, seed, sample)
    described = (
        Stratum(family, role, len(those), sum(one.id in drawn for one in those))
        for (family, role), those in strata.items()
    )
    drawing = Drawing(sample.text, len(mutants), tuple(described))
    return [mutant for mutant in mutants if mutant.id in drawn], drawing


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
        yield from shuffled(those, f"{seed}:sample")[: sizes[role]]


def _strata(mutants: Iterable[Mutant]) -> dict[tuple[str, str], list[Mutant]]:
    strata: dict[tuple[str, str], list[Mutant]] = {}
    for mutant in mutants:
        strata.setdefault((mutant.family, mutant.site.role.value), []).append(mutant)
    return strata


def shuffled(mutants: Iterable[Mutant], salt: str) -> list[Mutant]:
    """In an order that each mutant's place depends on by its own id only."""
    return sorted(mutants, key=lambda one: blake2b(f"{salt}:{one.id}".encode(), digest_size=16).digest())


def make_plan(baseline: Baseline, project: Project) -> Plan:
    """All mutants that are asked for, provider by provider; the baseline learns of their places."""
    plan = Plan([], [])
    planned = {
        provider: provider.plan(project, baseline.prepared.get(provider.name, Preparation()), baseline)
        for provider in asked_for(project)
    }
    baseline.take_in({provider.name: found for provider, found in planned.items()})
    for _, together in groupby(planned, key=lambda one: one.numbered_with or one.name):
        found = sorted(
            (one for provider in together for one in planned[provider].mutants), key=lambda one: one.order
        )
        plan.left_out.extend(one.as_left_out for one in found if one.reason is not None)
        first = len(plan.mutants) + 1
        made = [one.mutant for one in found if one.reason is None]
        plan.mutants.extend(replace(one, number=number) for number, one in enumerate(made, start=first))
    return plan
