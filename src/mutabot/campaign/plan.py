"""The plan: the mutants of all providers that are asked for, with their numbers, or a random sample of them.

What is drawn depends on the campaign's seed and the mutants' ids alone, so it is the same on every machine; a
new mutant elsewhere takes the place of one other at most, and a larger sample holds the smaller one. Mutants
of earlier campaigns stay in the journal with their outcomes, and reports show them beside those of the last.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from hashlib import blake2b
from itertools import groupby
from typing import TYPE_CHECKING

from mutabot.campaign.faults.planned import planned_by
from mutabot.campaign.faults.providers import provider, rules_of, selected_providers
from mutabot.faults import Project, known_families
from mutabot.frozen import frozen
from mutabot.journal.records import Drawing, Reaching, Stratum
from mutabot.model import LeftOut, Mutant
from mutabot.model.mutant import Place

if TYPE_CHECKING:
    from mutabot.campaign.baseline.baseline import Baseline
    from mutabot.campaign.request import Request
    from mutabot.config.options import Sample
    from mutabot.operators.operator import Rule


@frozen
class Plan:
    """The mutants to run, and those that are left out.

    Attributes:
        drawing: how the mutants were drawn from the selected ones; None if all of these are there.
    """

    mutants: list[Mutant]
    left_out: list[LeftOut]
    drawing: Drawing | None = None


def draw(mutants: Sequence[Mutant], seed: int, sample: Sample) -> tuple[list[Mutant], Drawing]:
    """Return the mutants to run, in their order and with their numbers, and how they were drawn."""
    strata: dict[tuple[str, str], list[Mutant]] = {}
    for mutant in mutants:
        strata.setdefault((mutant.family, mutant.site.role.value), []).append(mutant)
    drawn: set[str] = set()
    for family in {family for family, _ in strata}:
        roles = {role: those for (name, role), those in strata.items() if name == family}
        for role, size in sample.sizes({role: len(those) for role, those in roles.items()}).items():
            drawn.update(mutant.id for mutant in shuffled(roles[role], f"{seed}:sample")[:size])
    described = (
        Stratum(family, role, len(those), sum(member.id in drawn for member in those))
        for (family, role), those in strata.items()
    )
    drawing = Drawing(sample.text, len(mutants), tuple(described))
    return [mutant for mutant in mutants if mutant.id in drawn], drawing


def shuffled(mutants: Iterable[Mutant], salt: str) -> list[Mutant]:
    """Shuffle mutants: the rank of each depends on its own id only."""
    return sorted(
        mutants, key=lambda mutant: blake2b(f"{salt}:{mutant.id}".encode(), digest_size=16).digest()
    )


def make_plan(baseline: Baseline, project: Project) -> Plan:
    """Return all mutants that are asked for, by provider, and add their places to the baseline."""
    plan = Plan([], [])
    planned = {provider: planned_by(provider, project, baseline) for provider in selected_providers(project)}
    for made in planned.values():
        made.reach_text(baseline)
    baseline.add_planned({provider.name: found for provider, found in planned.items()})
    for _, together in groupby(planned, key=lambda provider: provider.numbered_with or provider.name):
        found = [item for provider in together for item in planned[provider].mutants]
        found.sort(key=lambda item: item.order)
        plan.left_out.extend(item.as_left_out for item in found if item.reason is not None)
        first = len(plan.mutants) + 1
        kept = [item.mutant for item in found if item.reason is None]
        plan.mutants.extend(replace(mutant, number=number) for number, mutant in enumerate(kept, start=first))
    return plan


def summaries(mutants: Iterable[Mutant]) -> dict[str, str]:
    """Return the summary of each operator that made one of the mutants, by its name."""
    mutants = list(mutants)
    known = {(by, rule.name): rule.summary for by, rule in _rules(mutants)}
    used = sorted({(mutant.family, mutant.operator, mutant.provider) for mutant in mutants})
    return {name: known[by, name] for _, name, by in used if (by, name) in known}


def of_common(mutants: Iterable[Mutant]) -> list[Mutant]:
    """Return the mutants among them of operators that ``--operators common`` keeps."""
    mutants = list(mutants)
    common = {(by, rule.name) for by, rule in _rules(mutants) if rule.is_common}
    return [mutant for mutant in mutants if (mutant.provider, mutant.operator) in common]


def _rules(mutants: Iterable[Mutant]) -> Iterator[tuple[str, Rule]]:
    """Yield the operators of these mutants' providers, each with the name of its provider."""
    for name in {mutant.provider: None for mutant in mutants}:
        yield from ((name, rule) for rule in provider(name).rules())


def drawing(mutants: Iterable[Mutant]) -> list[str]:
    """Return the names of the operators of these mutants that draw a number for each round."""
    used = {(mutant.provider, mutant.operator) for mutant in mutants}
    return sorted(name for by, name in used if provider(by).draws(name))


def reaching(baseline: Baseline, mutants: Iterable[Mutant]) -> Reaching:
    """Return which tests reach the sites of the mutants in any round."""
    numbers: dict[str, int] = {}
    sites: dict[str, set[int]] = {}
    for place in dict.fromkeys(map(Place.of, mutants)):
        reached = sites.setdefault(place.site.id, set())
        for round in range(len(baseline.tests)):
            tests = baseline.reaching.get((round, place), ())
            reached.update(numbers.setdefault(test, len(numbers)) for test in tests)
    return Reaching(tuple(numbers), {site: tuple(sorted(found)) for site, found in sites.items()})


def carry_over(
    known: Iterable[Mutant], request: Request, planned: Sequence[Mutant], whole: Iterable[Mutant]
) -> list[Mutant]:
    """Return the mutants of earlier campaigns that the program still has and that are not planned now.

    ``whole``: all that the program has now, of the families of this campaign, with their numbers. Mutants of
    other families are kept, for of these nothing is known now. A number that is taken gives way.
    """
    now = {mutant.id: mutant for mutant in whole}
    done = {mutant.id for mutant in planned}
    found = [
        now.get(mutant.id, mutant)
        for mutant in known
        if mutant.id not in done and (mutant.id in now or mutant.family not in request.families)
    ]
    return renumbered(found, planned)


def renumbered(mutants: Sequence[Mutant], planned: Sequence[Mutant]) -> list[Mutant]:
    """Return mutants with numbers that no planned mutant has."""
    taken = {mutant.number for mutant in planned}
    last = max((mutant.number for mutant in (*planned, *mutants)), default=0)
    found = []
    for mutant in sorted(mutants, key=lambda mutant: mutant.number):
        if mutant.number in taken:
            last += 1
            found.append(replace(mutant, number=last))
        else:
            found.append(mutant)
        taken.add(found[-1].number)
    return found


def listed_rules(families: Collection[str] = ()) -> list[dict[str, str]]:
    """Describe the operators of these families, or all: by family, in the order of the documentation.

    ``source`` is the bug class that one stands for, or the published operators that it makes; else empty.
    ``common`` is ``yes`` for those that ``--operators common`` keeps; else empty.

    Raises OperatorError for a plug-in that is of no use.
    """
    wanted = [family for family in known_families() if not families or family in families]
    rules = [rule for rule in rules_of(wanted) if rule.family in wanted]
    found = []
    for rule in sorted(rules, key=lambda rule: wanted.index(rule.family)):
        facts = {name: getattr(rule, name) for name in ("name", "family", "summary", "where")}
        published = f"Published operators: {rule.published}." if rule.published else ""
        common = "yes" if rule.is_common else ""
        found.append({**facts, "source": rule.rationale or published, "common": common})
    return found
