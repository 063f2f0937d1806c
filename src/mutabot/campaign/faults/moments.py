"""Mutants at moments: the same faults, but not at every call of their sites."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.faults import Planted
from mutabot.model import Moment, Mutant, Vocabulary
from mutabot.model.mutant import Place, When
from mutabot.operators import Need, operator


def at_moments(
    planted: Sequence[Planted], baseline: Baseline, vocabulary: Vocabulary, wanted: Sequence[Moment | None]
) -> list[Planted]:
    """Each mutant at each of these moments; None is every call."""
    found = [one for one in planted if one.reason is not None]
    for one in planted:
        for moment in wanted if one.reason is None else ():
            made = one.mutant if moment is None else _at(one.mutant, moment, baseline)
            reason = _why_not(made, vocabulary, baseline)
            order = one.order if reason is None else (1, *one.order[1:])  # left out here: behind the others
            found.append(replace(one, mutant=made, reason=reason, order=order))
    return found


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
