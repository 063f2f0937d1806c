"""What reports are told of a plan beside its mutants: what operators do, and which tests reach its sites."""

from __future__ import annotations

from collections.abc import Iterable

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.faults.providers import provider
from mutabot.journal.records import Reaching
from mutabot.model import Mutant
from mutabot.model.mutant import Place


def summaries(mutants: Iterable[Mutant]) -> dict[str, str]:
    """The summary of each operator that made one of the mutants, by its name."""
    mutants = list(mutants)
    providers = {one.provider: provider(one.provider) for one in mutants}
    known = {(name, rule.name): rule.summary for name, one in providers.items() for rule in one.rules()}
    used = sorted({(one.family, one.operator, one.provider) for one in mutants})
    return {name: known[by, name] for _, name, by in used if (by, name) in known}


def drawing(mutants: Iterable[Mutant]) -> list[str]:
    """The names of the operators among them that draw a number for each round."""
    used = {(mutant.provider, mutant.operator) for mutant in mutants}
    return sorted(name for by, name in used if provider(by).draws(name))


def reaching(baseline: Baseline, mutants: Iterable[Mutant]) -> Reaching:
    """Which tests reach the sites of the mutants in any round."""
    numbers: dict[str, int] = {}
    sites: dict[str, set[int]] = {}
    for place in dict.fromkeys(map(Place.of, mutants)):
        reached = sites.setdefault(place.site.id, set())
        for round in range(len(baseline.tests)):
            tests = baseline.reaching.get((round, place), ())
            reached.update(numbers.setdefault(test, len(numbers)) for test in tests)
    return Reaching(tuple(numbers), {site: tuple(sorted(found)) for site, found in sites.items()})
