"""Mutants at moments: the same faults, but not at every call of their sites."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.places import Place
from mutabot.model import LeftOut, Moment, Mutant, Vocabulary
from mutabot.model.moment import When
from mutabot.operators import Need, operator

from .planned import Plan


def at_moments(
    plan: Plan, baseline: Baseline, vocabulary: Vocabulary, wanted: Sequence[Moment | None]
) -> Plan:
    """The plan with each mutant at each of these moments; None is every call."""
    mutants: list[Mutant] = []
    left_out = list(plan.left_out)
    for mutant in plan.mutants:
        for moment in wanted:
            made = mutant if moment is None else _at(mutant, moment, baseline)
            reason = _why_not(made, vocabulary, baseline)
            if reason is None:
                mutants.append(replace(made, number=len(mutants) + 1))
            else:
                left_out.append(LeftOut(made.id, made.description, reason))
    return replace(plan, mutants=mutants, left_out=left_out)


def _at(mutant: Mutant, moment: Moment, baseline: Baseline) -> Mutant:
    if moment.when is When.ONCE:
        counts = {f"{round} {test}": count for (round, test), count in _calls(mutant, baseline).items()}
        moment = replace(moment, calls=counts)
    return replace(mutant, moment=moment, description=f"{mutant.description}, {moment.words}")


def _why_not(mutant: Mutant, vocabulary: Vocabulary, baseline: Baseline) -> str | None:
    moment = mutant.moment
    if moment is None:
        return None
    if Need.MEMORY in operator(mutant.operator).needs:
        return "what it does to a call depends on earlier ones, so that it acts at all of them"
    if moment.asks_time and vocabulary.clock is None:
        return "the vocabulary names no clock"
    most = max(_calls(mutant, baseline).values(), default=0)
    if moment.first > most and not moment.asks_time:
        return f"no test makes call {moment.first:g} here; the most are {most}"
    return None


def _calls(mutant: Mutant, baseline: Baseline) -> Counter[tuple[int, str]]:
    """How many calls the site has in each test of each round."""
    return Counter(hit.where for hit in baseline.hits.get(Place.of(mutant), ()))
