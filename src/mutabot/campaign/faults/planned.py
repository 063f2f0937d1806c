"""Apply the settings of any provider's mutants: moments, demanded magnitudes, and ladders last.

An operator declares what of it applies: ``Rule.has_moments``, ``Rule.has_sizes``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from mutabot.model.mutant import Place, When
from mutabot.thresholds.demands import is_same
from mutabot.thresholds.planned import demanded_of, split_ladders

if TYPE_CHECKING:
    from mutabot.faults import FaultProvider, Planned, PlannedMutant, Project
    from mutabot.model import Moment, Mutant
    from mutabot.operators.operator import Rule
    from mutabot.original import Original


def planned_by(provider: FaultProvider, project: Project, original: Original) -> Planned:
    """Return what a provider plans, at the moments and magnitudes that are asked for.

    Mutants with sizes come behind all others, whose numbers are the same with and without them.
    """
    rules = {rule.name: rule for rule in provider.rules()}
    asked = [rule.family for rule in rules.values() if project.asks_for(rule)]
    made = provider.plan(
        replace(project, families=tuple(dict.fromkeys((*project.families, *asked)))), original
    )
    found = made.mutants
    if project.moments != (None,):
        found = _at_moments(found, original, project, rules)
    made.mutants = _ladders_last(_with_demanded(found, provider, project))
    return made


def _at_moments(
    planted: Sequence[PlannedMutant], original: Original, project: Project, rules: Mapping[str, Rule]
) -> list[PlannedMutant]:
    """Return the mutants; each whose operator has moments stands once for each moment asked for."""
    found = []
    for planned in planted:
        rule = rules.get(planned.mutant.operator)
        if planned.reason is not None or rule is None or not rule.has_moments:
            found.append(planned)
            continue
        for moment in project.moments:
            made = planned.mutant if moment is None else _at(planned.mutant, moment, original)
            reason = _why_not(made, rule, project, original)
            # what is left out here comes behind the others
            order = planned.order if reason is None else (1, *planned.order[1:])
            found.append(replace(planned, mutant=made, reason=reason, order=order))
    return found


def _at(mutant: Mutant, moment: Moment, original: Original) -> Mutant:
    if moment.when is When.ONCE:
        counts = {f"{round} {test}": count for (round, test), count in _calls_at(mutant, original).items()}
        moment = replace(moment, calls=counts)
    return replace(mutant, moment=moment, description=f"{mutant.description}, {moment.phrase}")


def _why_not(mutant: Mutant, rule: Rule, project: Project, original: Original) -> str | None:
    moment = mutant.moment
    if moment is None:
        return None
    if rule.takes_all_calls():
        return "what it does to a call depends on earlier ones, so that it acts at all of them"
    if moment.asks_time and project.vocabulary.clock is None:
        return "the vocabulary names no clock"
    if moment.when is When.ONCE and not mutant.operation:
        return "how often a test reaches it is not known, so that no moment can be drawn"
    most = max(_calls_at(mutant, original).values(), default=0)
    is_reached = Place.of(mutant) in original.hits
    if is_reached and moment.first > most and not moment.asks_time:
        return f"no test makes call {moment.first:g} here; the most are {most}"
    return None


def _calls_at(mutant: Mutant, original: Original) -> Counter[tuple[int, str]]:
    """Return how many calls the site has in each test of each round."""
    return Counter(hit.where for hit in original.hits.get(Place.of(mutant), ()))


def _with_demanded(
    planted: Sequence[PlannedMutant], provider: FaultProvider, project: Project
) -> list[PlannedMutant]:
    """Return the mutants, with one added for each demanded magnitude that its ladder lacks.

    Where a family was not asked for, the ladders stay of which a demand speaks, and no others of it.
    """
    demands, families = project.demands, project.families
    if not demands:
        return [*planted]
    ladders = split_ladders(planned.mutant for planned in planted if planned.reason is None)[1]
    wanted = demanded_of(ladders, demands, project.vocabulary)
    found = [
        planned
        for planned in planted
        if planned.mutant.family in families
        or (planned.mutant.has_sizes and (planned.reason is not None or wanted.get(planned.mutant.ladder)))
    ]
    least = {mutants[0].id for mutants in ladders.values()}
    firsts = {
        planned.mutant.ladder: planned
        for planned in found
        if planned.reason is None and planned.mutant.id in least
    }
    for name, mutants in ladders.items():
        found += [
            provider.at_magnitude(firsts[name], size)
            for size in wanted.get(name, ())
            if not any(is_same(mutant.magnitude or 0.0, size) for mutant in mutants)
        ]
    return found


def _ladders_last(planted: Sequence[PlannedMutant]) -> list[PlannedMutant]:
    """Renumber the mutants so that graded ones come last, ladder by ladder."""
    _, ladders = split_ladders(planned.mutant for planned in planted if planned.reason is None)
    steps = [mutant.id for mutants in ladders.values() for mutant in mutants]
    order = {mutant: (1, number) for number, mutant in enumerate(steps)}
    others = (
        (planned, order.get(planned.mutant.id) if planned.reason is None else None) for planned in planted
    )
    return [replace(planned, order=(0, *planned.order) if last is None else last) for planned, last in others]
