"""Ladders: all magnitudes of one fault at one site, quantity, operator and direction, by round.

The thresholds of R rounds are taken as independent draws. How many of them lie below the median is then a
binomial number, whatever their distribution is, so that two of them, in order, hold the median between them
with a known probability. As each is known only as a bracket, the interval goes from the lower end of one to
the upper end of the other, which can only widen it. docs/thresholds.md has how often they hold it.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from typing import Protocol

from mutabot.errors import plural
from mutabot.frozen import frozen
from mutabot.model import By, Mutant, Outcome, Quantity, Verdict
from mutabot.model.units import UNITS
from mutabot.thresholds.brackets import Bracket, bracket_of, seen
from mutabot.thresholds.demands import OFFSET, is_same

#: the confidence of all intervals in reports
LEVEL = 0.95


class GradedResult(Protocol):
    """The interface of one graded mutant's outcomes in each round, None where it was not run."""

    @property
    def mutant(self) -> Mutant: ...
    @property
    def rounds(self) -> tuple[Outcome | None, ...]: ...
    @property
    def quantity(self) -> Quantity | None: ...


class GradedResults(Protocol):
    """The interface of all graded mutants of a campaign, and how the campaign ended."""

    @property
    def graded(self) -> Sequence[GradedResult]: ...
    @property
    def rounds(self) -> int: ...
    @property
    def state(self) -> str: ...


@frozen
class Between:
    """The interval of the median threshold of further rounds: above ``low``, at most ``high``.

    Attributes:
        low: a magnitude that was missed; 0 where none was.
        high: a magnitude that was noticed; infinite where none was.
        level: how often such an interval holds the median, at least.
    """

    low: float
    high: float
    level: float


def median_between(lows: Sequence[float], highs: Sequence[float], level: float = LEVEL) -> Between | None:
    """Return the interval of the median threshold, by the rounds' brackets; None with fewer than two.

    Args:
        lows: their lower ends, in any order; 0 where even the smallest fault was noticed.
        highs: their upper ends; infinite where none was noticed.
        level: the least level. Where even all rounds do not reach it, they are taken from the first to the
            last, and the interval has the level that this gives.
    """
    rounds = len(lows)
    if rounds < 2:
        return None
    first, last = ranks(rounds, level) or (1, rounds)
    outside = binomial_at_most(first - 1, rounds, 0.5) + binomial_at_most(rounds - last, rounds, 0.5)
    return Between(sorted(lows)[first - 1], sorted(highs)[last - 1], 1.0 - outside)


def ranks(rounds: int, level: float = LEVEL) -> tuple[int, int] | None:
    """Return which rounds, ranked by their thresholds from 1, enclose the median; None if none do.

    None if there are too few rounds for the level.
    """
    tail = (1.0 - level) / 2.0
    first = 0
    while binomial_at_most(first, rounds, 0.5) <= tail:
        first += 1
    return (first, rounds + 1 - first) if first else None


def share_noticed(rounds: int, level: float = LEVEL) -> float:
    """Return the share of all rounds that notice what these rounds notice (Wilks 1941)."""
    return float((1.0 - level) ** (1.0 / rounds)) if rounds else 0.0


def binomial_at_most(count: int, of: int, share: float) -> float:
    """Return the probability of at most ``count`` successes."""
    return math.fsum(math.comb(of, k) * share**k * (1.0 - share) ** (of - k) for k in range(count + 1))


#: what ends a ladder without a word about the tests
_NOTHING_THERE = frozenset({Verdict.NO_EFFECT, Verdict.INVALID})


class NextLarger(StrEnum):
    """The kind of result above the largest magnitude that was missed."""

    NOTICED = "noticed"
    LARGEST = "missed up to the largest"
    REFUSED = "refused"
    NO_EFFECT = "no effect"
    #: it was not run, or the result is unknown
    OPEN = "open"


@frozen
class LadderRound:
    """One ladder in one round.

    Attributes:
        number: 0-based round.
        outcomes: by magnitude, rising, those that were run.
        bracket: where the threshold lies.
        above: what is above the largest magnitude that was missed.
    """

    number: int
    outcomes: Mapping[float, Outcome]
    bracket: Bracket
    above: NextLarger

    @classmethod
    def of(cls, number: int, sizes: Sequence[float], outcomes: Mapping[float, Outcome]) -> LadderRound:
        """Make it from the planned magnitudes, rising, and the outcomes of those that were run."""
        bracket = bracket_of({size: seen(outcome) for size, outcome in outcomes.items()})
        if any(outcome.verdict is Verdict.NOT_COVERED for outcome in outcomes.values()):
            bracket = Bracket(low=sizes[-1])  # what no test reaches, none reaches at any magnitude
        return cls(number, outcomes, bracket, _above(bracket, sizes, outcomes))

    @property
    def is_reached(self) -> bool:
        """Whether a test reaches the site."""
        return not any(outcome.verdict is Verdict.NOT_COVERED for outcome in self.outcomes.values())

    @property
    def why_out(self) -> str:
        """Why the round does not count; empty if it does."""
        if not self.outcomes:
            return "was not run"
        if not self.bracket.is_known:
            verdicts = {outcome.verdict for outcome in self.outcomes.values()}
            return next((text for end, text in _WORDS.items() if end in verdicts), "says nothing")
        if self.above is NextLarger.OPEN:
            return "is not judged to the end of the ladder"
        return ""

    @property
    def counts(self) -> bool:
        """Whether the round counts, that is, says something about the tests."""
        return not self.why_out

    @property
    def noticed_by(self) -> str | None:
        """What notices the fault at the bracket's upper end: ``check``, ``exception`` or ``timeout``."""
        if self.bracket.high is None:
            return None
        outcome = self.outcomes[self.bracket.high]
        return (outcome.by or By.EXCEPTION).value if outcome.verdict is Verdict.KILLED else "timeout"


def _above(bracket: Bracket, sizes: Sequence[float], outcomes: Mapping[float, Outcome]) -> NextLarger:
    if bracket.high is not None:
        return NextLarger.NOTICED
    above = [size for size in sizes if bracket.low is None or size > bracket.low]
    if not above:
        return NextLarger.LARGEST
    if bracket.refused is not None:
        return NextLarger.REFUSED
    # the next one decides: what changes nothing there is beyond what the robot takes
    ends = {outcomes[size].verdict for size in above if size in outcomes}
    return NextLarger.NO_EFFECT if above[0] in outcomes and ends <= _NOTHING_THERE else NextLarger.OPEN


#: why nothing is known of a round, the worst first
_WORDS = {
    Verdict.ERROR: "ended in error",
    Verdict.UNSTABLE: "is unstable",
    Verdict.REFUSED: "the robot refuses every magnitude that was tried",
    Verdict.GUARDED: "a guard refuses every magnitude that was tried",
    Verdict.NO_EFFECT: "has no effect",
    Verdict.INVALID: "is invalid",
}


_SIGNS = {"+": "+", "-": "−"}


@frozen
class Violation:
    """A larger fault that was missed where a smaller one was noticed."""

    round: int
    noticed: float
    missed: float


@frozen
class Ladder:
    """All magnitudes of one graded fault.

    Attributes:
        id: what its mutants share.
        results: its mutants, rising.
        rounds: what became of it, round by round.
    """

    id: str
    results: tuple[GradedResult, ...]
    rounds: tuple[LadderRound, ...]

    @property
    def mutant(self) -> Mutant:
        """The mutant of the smallest magnitude."""
        return self.results[0].mutant

    @property
    def quantity(self) -> Quantity | None:
        """The quantity that the fault changes, if the journal holds the vocabulary."""
        return self.results[0].quantity

    @property
    def unit(self) -> str | None:
        """The unit of its magnitudes."""
        return self.mutant.unit

    @property
    def sizes(self) -> tuple[float, ...]:
        """Its magnitudes, rising."""
        return tuple(result.mutant.magnitude or 0.0 for result in self.results)

    @property
    def place(self) -> str:
        """The place as text: ``sorting.py:38``; all places of a fault that has several."""
        return ", ".join(span.place for span in self.mutant.site.spans)

    @property
    def name(self) -> str:
        """The name: ``arm.move_by y +``; with the operator unless it is an offset, and the axis of a turn."""
        mutant, way = self.mutant, self.mutant.direction
        operator = mutant.operator if mutant.operator != OFFSET else ""
        moment = f"@{mutant.moment.text}" if mutant.moment is not None else ""
        fault = (mutant.site.text, mutant.pattern_name, mutant.quantity, operator, moment)
        return " ".join(part for part in (*fault, way[:-1], _SIGNS.get(way[-1:], "")) if part)

    @property
    def counted(self) -> tuple[LadderRound, ...]:
        """The rounds that count, by the order of their thresholds."""
        return tuple(sorted((row for row in self.rounds if row.counts), key=_order))

    @property
    def lows(self) -> tuple[float, ...]:
        """The lower ends of their brackets, rising; 0 where even the smallest fault was noticed."""
        return tuple(sorted(row.bracket.low or 0.0 for row in self.counted))

    @property
    def highs(self) -> tuple[float, ...]:
        """The upper ends, rising; infinite where nothing was noticed."""
        ends = (row.bracket.high for row in self.counted)
        return tuple(sorted(math.inf if end is None else end for end in ends))

    @property
    def none_up_to(self) -> float:
        """The magnitude up to which no round notices it; 0 if a round notices the smallest one."""
        return self.lows[0]

    @property
    def half_from(self) -> float:
        """The magnitude from which at least half of the rounds notice it; inf if there is none."""
        return self.highs[math.ceil(len(self.highs) / 2) - 1]

    @property
    def all_from(self) -> float:
        """The magnitude from which all rounds notice it; inf if there is none."""
        return self.highs[-1]

    @property
    def median(self) -> Between | None:
        """The interval of the median threshold of further rounds; None with fewer than two rounds."""
        return median_between(self.lows, self.highs)

    @property
    def share_shown(self) -> float | None:
        """The least share of further rounds that notice it from ``all_from`` on; None if there is none."""
        return share_noticed(len(self.counted)) if math.isfinite(self.all_from) else None

    @property
    def violations(self) -> tuple[Violation, ...]:
        """Per round the smallest magnitude that was noticed below a larger one that was missed, if any."""
        return tuple(
            Violation(row.number, row.bracket.out_of_order[0][0], row.bracket.out_of_order[-1][1])
            for row in self.rounds
            if row.bracket.is_violated
        )

    @property
    def refused_from(self) -> float | None:
        """The smallest magnitude from which on all results of a round are refusals; None if there is none."""
        ends = (row.bracket.refused for row in self.counted if row.bracket.high is None)
        return min((end for end in ends if end is not None), default=None)

    @property
    def why_unjudged(self) -> str:
        """Why the ladder cannot be judged; empty if it can."""
        if any(row.counts for row in self.rounds):
            return ""
        reasons = Counter(row.why_out for row in self.rounds)
        ranked = [
            f"{reason} ({count} of {plural(len(self.rounds), 'round')})"
            for reason, count in reasons.most_common()
        ]
        return ranked[0].partition(" (")[0] if len(reasons) == 1 else "; ".join(ranked)

    def number_of(self, magnitude: float) -> int | None:
        """Return the number of the mutant of this magnitude; None if the ladder has none."""
        found = (
            result.mutant for result in self.results if is_same(result.mutant.magnitude or 0.0, magnitude)
        )
        return next((mutant.number for mutant in found), None)


def looseness(ladder: Ladder) -> tuple[float, float, float]:
    """Return a sort key that is greater for ladders that tolerate larger faults.

    Magnitudes of different units are compared in those of the SI: a milliradian counts as a millimetre, which
    it is at a metre's reach.
    """
    factor = UNITS[ladder.unit].factor if ladder.unit in UNITS else 1.0
    ends = (ladder.all_from, ladder.half_from, ladder.none_up_to)
    first, second, third = (end * factor for end in ends)
    return first, second, third


def ladders_of(results: GradedResults) -> tuple[Ladder, ...]:
    """Return the ladders of a campaign, in the order of its plan."""
    found: dict[str, list[GradedResult]] = {}
    for result in results.graded:
        found.setdefault(result.mutant.ladder, []).append(result)
    return tuple(_ladder(name, those, results.rounds) for name, those in found.items())


def _ladder(name: str, results: Iterable[GradedResult], rounds: int) -> Ladder:
    rising = sorted(
        ((result.mutant.magnitude or 0.0, result) for result in results), key=lambda pair: pair[0]
    )
    found = []
    for number in range(rounds):
        outcomes = {size: outcome for size, result in rising if (outcome := result.rounds[number])}
        found.append(LadderRound.of(number, [size for size, _ in rising], outcomes))
    return Ladder(name, tuple(result for _, result in rising), tuple(found))


def _order(ladder_round: LadderRound) -> tuple[float, float, int]:
    high = ladder_round.bracket.high
    return math.inf if high is None else high, ladder_round.bracket.low or 0.0, ladder_round.number
