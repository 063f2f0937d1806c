"""What reports are told of a plan beside its mutants: what operators do, and which tests reach its sites."""

from __future__ import annotations

from collections.abc import Iterable

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.places import Place
from mutabot.families import OF_TEXT
from mutabot.journal.records import Reaching
from mutabot.model import Mutant
from mutabot.operators import operator
from mutabot_source.registry import load_all


def summaries(mutants: Iterable[Mutant]) -> dict[str, str]:
    """The summary of each operator that made one of the mutants, by its name."""
    used = sorted({(single.family, single.operator) for mutant in mutants for single in mutant.singles})
    of_text = {family for family, _ in used} & set(OF_TEXT)
    texts = {rule.name: rule.summary for rule in load_all()} if of_text else {}
    return {name: texts[name] if family in of_text else operator(name).summary for family, name in used}


def drawing(mutants: Iterable[Mutant]) -> list[str]:
    """The names of the operators among them that draw a number for each round."""
    used = {
        single.operator for mutant in mutants for single in mutant.singles if single.family not in OF_TEXT
    }
    return sorted(name for name in used if operator(name).draws)


def reaching(baseline: Baseline, mutants: Iterable[Mutant]) -> Reaching:
    """Which tests reach the sites of the mutants in any round."""
    numbers: dict[str, int] = {}
    sites: dict[str, set[int]] = {}
    for place in {Place.of(single): None for mutant in mutants for single in mutant.singles}:
        reached = sites.setdefault(place.site.id, set())
        for round in range(len(baseline.tests)):
            tests = baseline.reaching.get((round, place), ())
            reached.update(numbers.setdefault(test, len(numbers)) for test in tests)
    return Reaching(tuple(numbers), {site: tuple(sorted(found)) for site, found in sites.items()})
