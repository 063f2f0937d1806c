"""The thresholds of a campaign: its ladders, their results, and unmet demands.

Words give brackets, and never a number between them.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mutabot.errors import plural, unknown_name_text
from mutabot.model import Outcome, Verdict
from mutabot.model.outcome_text import numbers_text
from mutabot.thresholds.brackets import MagnitudeResult, seen
from mutabot.thresholds.demands import Demand, is_at_least, is_same
from mutabot.thresholds.ladders import Ladder, LadderRound, NextLarger, ladders_of, looseness

if TYPE_CHECKING:
    from .ladders import GradedResults


def magnitude_text(magnitude: float, unit: str | None) -> str:
    """Return a magnitude as text: ``20 mm``; fractions in percent, numbers without a unit."""
    if unit in ("fraction", "percent"):
        return f"{magnitude * (100 if unit == 'fraction' else 1):.6g} %"
    return f"{magnitude:.6g}{f' {unit}' if unit is not None else ''}"


def ladder_line(ladder: Ladder) -> str:
    """Return the line of a ladder that can be judged: a fact about these rounds."""
    brackets = {(row.bracket.low, row.bracket.high, row.above) for row in ladder.counted}
    if not any(row.is_reached for row in ladder.counted):
        return f"no test reaches it{_all(ladder)}"
    return _alike(ladder) if len(brackets) == 1 else _apart(ladder)


def rounds_left_out(ladder: Ladder) -> Iterator[str]:
    """Yield the rounds that do not count although others do, each with the reason."""
    for row in ladder.rounds:
        if row.why_out:
            yield f"round {row.number + 1} {row.why_out}"


def _alike(ladder: Ladder) -> str:
    row = ladder.counted[0]
    low, high = row.bracket.low, row.bracket.high
    if high is None:
        return f"{_never(ladder, row)}{_all(ladder)}"
    if low is None:
        return f"noticed from {_smallest(ladder, high)}{_all(ladder)}"
    return f"noticed from {_text(ladder, high)}, not at {_text(ladder, low)}{_all(ladder)}"


def _apart(ladder: Ladder) -> str:
    total = len(ladder.counted)
    parts = [
        f"in {f'all {total}' if count == total else f'{count} of {total}'} rounds from {where}"
        for count, where in _noticed(ladder)
    ]
    text = ", ".join(part.replace(" rounds", "", 1) if number else part for number, part in enumerate(parts))
    ends = [f"noticed {text}"] if text else []
    if math.isfinite(ladder.all_from):
        ends += [f"in none up to {_text(ladder, ladder.none_up_to)}"] if ladder.none_up_to else []
    else:
        ends += _never_noticed(ladder)
    return "; ".join(ends)


def _noticed(ladder: Ladder) -> Iterator[tuple[int, str]]:
    """Yield from which magnitude the first, half and all of the rounds notice it."""
    highs = [high for high in ladder.highs if math.isfinite(high)]
    wanted = {highs[0], highs[-1], ladder.half_from} if highs else set()
    for high in sorted(size for size in wanted if math.isfinite(size)):
        count = sum(size <= high for size in highs)
        yield count, _smallest(ladder, high) if high == ladder.sizes[0] else _text(ladder, high)


def _never_noticed(ladder: Ladder) -> Iterator[str]:
    """Yield the rounds that never notice it, equal ones together."""
    rounds = [row for row in ladder.counted if row.bracket.high is None]
    total = len(ladder.counted)
    for text, count in Counter(_never(ladder, row) for row in rounds).items():
        yield f"{text} ({count} of {plural(total, 'round')})"


def _never(ladder: Ladder, ladder_round: LadderRound) -> str:
    low = ladder_round.bracket.low
    if not ladder_round.is_reached:
        return "no test reaches it"
    missed = f"not noticed up to {_text(ladder, low)}" if low is not None else ""
    above = ""
    if ladder_round.above is NextLarger.REFUSED and ladder_round.bracket.refused is not None:
        above = f"refused from {_text(ladder, ladder_round.bracket.refused)}"
    elif ladder_round.above is NextLarger.NO_EFFECT:
        above = "without effect above"
    return ", ".join(part for part in (missed, above) if part)


def _smallest(ladder: Ladder, high: float) -> str:
    return f"the smallest tried, {_text(ladder, high)}"


def _all(ladder: Ladder) -> str:
    """Return how many rounds a fact is about that holds in all of them."""
    total = len(ladder.counted)
    return f" (all {total} rounds)" if total > 1 else " (1 round)"


def _text(ladder: Ladder, magnitude: float) -> str:
    return magnitude_text(magnitude, ladder.unit)


def describe_violations(ladder: Ladder) -> Iterator[str]:
    """Yield violations as text: ``noticed at 5 mm, survives 20 mm, round 3``; equal rounds together."""
    rounds: dict[tuple[float, float], list[int]] = {}
    for violation in ladder.violations:
        rounds.setdefault((violation.noticed, violation.missed), []).append(violation.round + 1)
    for (noticed, missed), numbers in rounds.items():
        ends = f"noticed at {_text(ladder, noticed)}, survives {_text(ladder, missed)}"
        yield f"{ends}, {numbers_text(numbers)}"


@dataclass(frozen=True)
class Thresholds:
    """The thresholds of a campaign.

    Attributes:
        ladders: those of which something is known, least sensitive first.
        unjudged: the others.
        rounds: number of rounds.
        state: how the campaign ended, as in ``Results``.
    """

    ladders: tuple[Ladder, ...]
    unjudged: tuple[Ladder, ...]
    rounds: int
    state: str

    @property
    def all(self) -> tuple[Ladder, ...]:
        """All ladders."""
        return (*self.ladders, *self.unjudged)

    @property
    def summary(self) -> str:
        """The summary: ``25 of 46 graded faults not noticed even at the largest size tried; …``."""
        counts = Counter(map(_in_all_rounds, self.ladders))
        counts["not judged"] = len(self.unjudged)
        kinds = [kind for kind in (*_KINDS, "not judged") if counts[kind]]
        total = f" of {plural(len(self.all), 'graded fault')}"
        return "; ".join(
            f"{counts[kind]}{'' if number else total} {kind}" for number, kind in enumerate(kinds)
        )


#: what a ladder shows over all rounds, what needs a look first
_KINDS = (
    "not noticed even at the largest size tried",
    "not noticed at any size that the robot accepts",
    "not noticed at any size that has an effect",
    "noticed in some rounds only",
    "noticed in every round from some size on",
    "reached by no test",
)


def _in_all_rounds(ladder: Ladder) -> str:
    """Return the kind of a ladder that can be judged."""
    largest, accepted, effective, some, every, unreached = _KINDS
    above = {row.above for row in ladder.counted}
    if not any(row.is_reached for row in ladder.counted):
        return unreached
    if math.isfinite(ladder.all_from):
        return every
    if NextLarger.NOTICED in above:
        return some
    return (
        accepted if NextLarger.REFUSED in above else effective if NextLarger.NO_EFFECT in above else largest
    )


def thresholds_of(results: GradedResults) -> Thresholds:
    """Return the thresholds of a campaign."""
    ladders = ladders_of(results)
    judged = (ladder for ladder in ladders if not ladder.why_unjudged)
    return Thresholds(
        ladders=tuple(sorted(judged, key=lambda ladder: [-end for end in looseness(ladder)])),
        unjudged=tuple(ladder for ladder in ladders if ladder.why_unjudged),
        rounds=results.rounds,
        state=results.state,
    )


def unmet(demands: Iterable[Demand], ladders: Sequence[Ladder]) -> Iterator[str]:
    """Yield the unmet demands: ``sorting.py:38 arm.move_by y +: survives 5 mm in round 3``."""
    kinds = {ladder.id: ladder.quantity.kind if ladder.quantity is not None else None for ladder in ladders}
    for demand in demands:
        about = [ladder for ladder in ladders if demand.is_about(ladder.mutant, kinds[ladder.id])]
        found = {f"{ladder.place} {ladder.name}": _why_unmet(demand, ladder) for ladder in about}
        if not about:
            found = {"no ladder": _why_nothing_fits(demand, ladders)}
        source = f"{demand.source} · " if demand.source else ""
        yield from (f"{source}{demand.text}: {where}: {why}" for where, why in found.items() if why)


def _why_unmet(demand: Demand, ladder: Ladder) -> str:
    """Return why a demand is not met in all rounds; empty if it is."""
    demanded = demand.magnitude_in(ladder.unit)
    assert demanded is not None, "it speaks of ladders of its own measure alone"
    survivors = [
        (row.number + 1, magnitude, outcome)
        for row in ladder.rounds
        for magnitude, outcome in row.outcomes.items()
        if is_at_least(magnitude, demanded) and seen(outcome) is MagnitudeResult.MISSED
    ]
    if survivors:
        return _survivors_text(ladder, survivors)
    size = _text(ladder, demanded)
    if ladder.number_of(demanded) is None:
        return f"{size} is not on its ladder; `mutabot run` again plants it"
    verdicts = {
        row.number + 1: next((end.verdict for at, end in row.outcomes.items() if is_same(at, demanded)), None)
        for row in ladder.rounds
    }
    for verdict, text in _UNKNOWN.items():
        rounds = [number for number, found in verdicts.items() if found is verdict]
        if rounds:
            return f"{size} {text} in {numbers_text(rounds)}{'' if verdict else '; `mutabot run` goes on'}"
    is_noticed = any(verdict is not None and verdict.is_killed for verdict in verdicts.values())
    if is_noticed or {*verdicts.values()} <= {Verdict.REFUSED, Verdict.GUARDED}:
        return ""
    return f"{size} has no effect in any round, so nothing is known; demand it of other sites"


#: ends of a round that say nothing of a magnitude, and what is said of them; None where it was not run
_UNKNOWN = {Verdict.UNSTABLE: "is unstable", Verdict.ERROR: "ended in error", None: "was not run"}


def _survivors_text(ladder: Ladder, survivors: Sequence[tuple[int, float, Outcome]]) -> str:
    unreached = [number for number, _, outcome in survivors if outcome.verdict is Verdict.NOT_COVERED]
    if unreached:
        return f"no test reaches it in {numbers_text(unreached)}"
    rounds: dict[float, list[int]] = {}
    for number, size, _ in survivors:
        rounds.setdefault(size, []).append(number)
    survived = [
        f"{_text(ladder, size)} in {numbers_text(numbers)} (mutant {ladder.number_of(size)})"
        for size, numbers in rounds.items()
    ]
    return f"survives {', '.join(survived)}"


def _why_nothing_fits(demand: Demand, ladders: Sequence[Ladder]) -> str:
    if not ladders:
        return (
            "the campaign has no graded mutants; `mutabot run` plants those of which a demand speaks, if any"
        )
    here = [ladder for ladder in ladders if demand.is_at(ladder.mutant)]
    if not here:
        places = {
            name
            for ladder in ladders
            for name in (ladder.place, ladder.mutant.site.id, ladder.mutant.site.text)
        }
        return unknown_name_text("site", demand.site or "", places)
    known = ", ".join(sorted({f"{ladder.name} in {ladder.unit or 'no unit'}" for ladder in here}))
    return f"fits none of {len(here)} ladders: {known}"
