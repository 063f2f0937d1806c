"""Ladders: all magnitudes of one fault at one site, quantity, operator and direction, round by round.

The thresholds of R rounds are taken as independent draws. How many of them lie below the median is then a
binomial number, whatever their distribution is, so that two of them, in order, hold the median between them
with a known probability. As each is known only as a bracket, the interval goes from the lower end of one to
the upper end of the other, which can only widen it. Measured by ``benchmarks/threshold_coverage.py``.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from enum import StrEnum
from itertools import pairwise

from mutabot.frozen import frozen
from mutabot.model import By, Mutant, Outcome, Quantity, Verdict
from mutabot.model.graded import OFFSET, Bracket, MagnitudeResult, bracket_of, is_same, seen
from mutabot.model.units import UNITS
from mutabot.results.results import MutantResult, Results
from mutabot.results.statistics import LEVEL, Interval

#: halvings of an interval until no digit changes
_HALVINGS = 60


@frozen
class Between:
    """Where the median threshold of further rounds like these lies: above ``low``, at most at ``high``.

    Attributes:
        low: a magnitude that was missed; 0 where none was.
        high: a magnitude that was noticed; infinite where none was.
        level: how often such an interval holds the median, at least.
    """

    low: float
    high: float
    level: float


def median_between(lows: Sequence[float], highs: Sequence[float], level: float = LEVEL) -> Between | None:
    """The interval of the median threshold, from the brackets of the rounds; None with fewer than two.

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
    """Which rounds, counted in the order of their thresholds from 1, have the median between them.

    None if there are too few rounds for the level.
    """
    tail = (1.0 - level) / 2.0
    first = 0
    while binomial_at_most(first, rounds, 0.5) <= tail:
        first += 1
    return (first, rounds + 1 - first) if first else None


def share_noticed(rounds: int, level: float = LEVEL) -> float:
    """The share of rounds that at least notice what all of these rounds notice (Wilks 1941)."""
    return float((1.0 - level) ** (1.0 / rounds)) if rounds else 0.0


def rounds_for(share: float, level: float = LEVEL) -> int:
    """How many rounds must all notice to show that at least this share of all rounds does; share below 1."""
    return math.ceil(math.log(1.0 - level) / math.log(share)) if share > 0.0 else 1


def exact(count: int, of: int, level: float = LEVEL) -> Interval | None:
    """Clopper and Pearson's interval of a share, whose true level is never less; None without trials."""
    if not of:
        return None
    tail = (1.0 - level) / 2.0
    return Interval(lower_limit(count, of, 1.0 - tail), upper_limit(count, of, 1.0 - tail), level)


def lower_limit(count: int, of: int, level: float = LEVEL) -> float:
    """The exact one-sided lower limit of a share."""
    if not count:
        return 0.0
    return _turn(lambda share: 1.0 - binomial_at_most(count - 1, of, share) > 1.0 - level)


def upper_limit(count: int, of: int, level: float = LEVEL) -> float:
    """The exact one-sided upper limit of a share."""
    if count >= of:
        return 1.0
    return _turn(lambda share: binomial_at_most(count, of, share) <= 1.0 - level)


def binomial_at_most(count: int, of: int, share: float) -> float:
    """The probability of at most ``count`` successes."""
    return math.fsum(math.comb(of, k) * share**k * (1.0 - share) ** (of - k) for k in range(count + 1))


def _turn(holds: Callable[[float], bool]) -> float:
    """Where, from 0 to 1, something begins to hold."""
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


#: what ends a ladder without a word about the tests
_NOTHING_THERE = frozenset({Verdict.NO_EFFECT, Verdict.INVALID})


class Above(StrEnum):
    """What is above the largest magnitude that was missed."""

    NOTICED = "noticed"
    LARGEST = "missed up to the largest"
    REFUSED = "refused"
    NO_EFFECT = "no effect"
    #: it was not run, or nobody knows
    OPEN = "open"


@frozen
class LadderRound:
    """One ladder in one round.

    Attributes:
        number: 0-based round.
        outcomes: by magnitude, rising, those that were run.
        zero: the outcome of magnitude 0; None if it was not run.
        bracket: where the threshold lies.
        above: what is above the largest magnitude that was missed.
    """

    number: int
    outcomes: Mapping[float, Outcome]
    zero: Outcome | None
    bracket: Bracket
    above: Above

    @classmethod
    def of(
        cls, number: int, sizes: Sequence[float], outcomes: Mapping[float, Outcome], zero: Outcome | None
    ) -> LadderRound:
        """From the planned magnitudes above 0, rising, and the outcomes of those that were run."""
        bracket = bracket_of({size: seen(one) for size, one in outcomes.items()})
        if any(one.verdict is Verdict.NOT_COVERED for one in outcomes.values()):
            bracket = Bracket(low=sizes[-1])  # what no test reaches, none reaches at any magnitude
        return cls(number, outcomes, zero, bracket, _above(bracket, sizes, outcomes))

    @property
    def fails_without_fault(self) -> bool:
        """Whether the tests fail at magnitude 0, so that nothing they notice is due to the fault."""
        return self.zero is not None and seen(self.zero) is MagnitudeResult.NOTICED

    @property
    def is_reached(self) -> bool:
        """Whether a test reaches the site."""
        return not any(one.verdict is Verdict.NOT_COVERED for one in self.outcomes.values())

    @property
    def why_out(self) -> str:
        """Why the round does not count; empty if it does."""
        if self.fails_without_fault:
            return "fails without a fault"
        if not self.outcomes:
            return "was not run"
        if not self.bracket.is_known:
            return _without_valid(self.outcomes)
        if self.above is Above.OPEN:
            return "is not judged to the end of the ladder"
        return ""

    @property
    def counts(self) -> bool:
        """Whether it says something about the tests."""
        return not self.why_out

    @property
    def noticed_by(self) -> str | None:
        """Who notices at the upper end of the bracket: ``check``, ``exception`` or ``timeout``."""
        return noticer(self.outcomes[self.bracket.high]) if self.bracket.high is not None else None


def noticer(outcome: Outcome) -> str | None:
    """Who noticed a fault: ``check``, ``exception`` or ``timeout``; None if nobody did."""
    if outcome.verdict is Verdict.TIMEOUT:
        return Verdict.TIMEOUT.value
    return (outcome.by or By.EXCEPTION).value if outcome.verdict is Verdict.KILLED else None


def _above(bracket: Bracket, sizes: Sequence[float], outcomes: Mapping[float, Outcome]) -> Above:
    if bracket.high is not None:
        return Above.NOTICED
    above = [size for size in sizes if bracket.low is None or size > bracket.low]
    if not above:
        return Above.LARGEST
    if bracket.refused is not None:
        return Above.REFUSED
    # the next one tells: what changes nothing there is beyond what the robot takes
    ends = list(_verdicts(above, outcomes))
    return Above.NO_EFFECT if ends and set(ends) <= _NOTHING_THERE and above[0] in outcomes else Above.OPEN


def _verdicts(sizes: Sequence[float], outcomes: Mapping[float, Outcome]) -> Iterator[Verdict]:
    return (outcomes[size].verdict for size in sizes if size in outcomes)


def _without_valid(outcomes: Mapping[float, Outcome]) -> str:
    verdicts = {one.verdict for one in outcomes.values()}
    for verdict, words in _WORDS.items():
        if verdict in verdicts:
            return words
    return "says nothing"


#: why nothing is known of a round, the worst first
_WORDS = {
    Verdict.ERROR: "ended in error",
    Verdict.UNSTABLE: "is unstable",
    Verdict.REFUSED: "the robot refuses every magnitude that was tried",
    Verdict.NO_EFFECT: "has no effect",
    Verdict.INVALID: "is invalid",
}


_SIGNS = {"+": "+", "-": "−"}


@frozen
class MagnitudeStep:
    """One magnitude of a ladder, over the rounds that do not fail without a fault.

    Attributes:
        magnitude: in the ladder's unit.
        number: of its mutant.
        by: rounds that notice it, by who does: ``check``, ``exception``, ``timeout``.
        missed: rounds that do not, also since no test reaches it.
        refused: rounds in which the robot refused it: no word about the tests.
        unknown: rounds in which it had no effect, was unstable or ended in error.
    """

    magnitude: float
    number: int
    by: Mapping[str, int]
    missed: int
    refused: int
    unknown: int

    @property
    def noticed(self) -> int:
        """Rounds that notice it."""
        return sum(self.by.values())

    @property
    def valid(self) -> int:
        """Rounds that say something about the tests."""
        return self.noticed + self.missed

    @property
    def interval(self) -> Interval | None:
        """Clopper and Pearson's interval of the share of rounds that notice it; None if none is valid."""
        return exact(self.noticed, self.valid)


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
        results: its mutants above magnitude 0, rising.
        zero: its mutant of magnitude 0; None if there is none.
        rounds: what became of it, round by round.
    """

    id: str
    results: tuple[MutantResult, ...]
    zero: MutantResult | None
    rounds: tuple[LadderRound, ...]

    @property
    def mutant(self) -> Mutant:
        """The smallest of its mutants."""
        return self.results[0].mutant

    @property
    def quantity(self) -> Quantity | None:
        """What it changes, if the journal holds the vocabulary."""
        return self.results[0].quantity

    @property
    def unit(self) -> str | None:
        """The unit of its magnitudes."""
        return self.mutant.unit

    @property
    def sizes(self) -> tuple[float, ...]:
        """Its magnitudes above 0, rising."""
        return tuple(one.mutant.magnitude or 0.0 for one in self.results)

    @property
    def place(self) -> str:
        """``sorting.py:38``."""
        return self.mutant.site.span.place

    @property
    def name(self) -> str:
        """``arm.move_by y +``; another operator than an offset is named, and the axis of a turn (``z +``)."""
        way = self.mutant.direction
        parts = (self.pair_name, way[:-1], _SIGNS.get(way[-1:], ""))
        return " ".join(part for part in parts if part)

    @property
    def pair_name(self) -> str:
        """The same without the direction."""
        mutant = self.mutant
        operator = mutant.operator if mutant.operator != OFFSET else ""
        moment = f"@{mutant.moment.text}" if mutant.moment is not None else ""
        pattern = mutant.pattern_name
        parts = (mutant.site.text, pattern, mutant.quantity, operator, moment)
        return " ".join(part for part in parts if part)

    @property
    def counted(self) -> tuple[LadderRound, ...]:
        """The rounds that count, by the order of their thresholds."""
        return tuple(sorted((one for one in self.rounds if one.counts), key=_order))

    @property
    def lows(self) -> tuple[float, ...]:
        """The lower ends of their brackets, rising; 0 where even the smallest fault was noticed."""
        return tuple(sorted(one.bracket.low or 0.0 for one in self.counted))

    @property
    def highs(self) -> tuple[float, ...]:
        """The upper ends, rising; infinite where nothing was noticed."""
        ends = (one.bracket.high for one in self.counted)
        return tuple(sorted(math.inf if end is None else end for end in ends))

    @property
    def none_up_to(self) -> float:
        """Up to here no round notices it; 0 if a round notices the smallest fault that was tried."""
        return self.lows[0]

    @property
    def half_from(self) -> float:
        """From here on at least half of the rounds notice it; infinite if they do not."""
        return self.highs[math.ceil(len(self.highs) / 2) - 1]

    @property
    def all_from(self) -> float:
        """From here on all rounds notice it; infinite if they do not."""
        return self.highs[-1]

    @property
    def median(self) -> Between | None:
        """Where the median threshold of further rounds lies; None with fewer than two rounds."""
        return median_between(self.lows, self.highs)

    @property
    def share_shown(self) -> float | None:
        """Of further rounds at least this share notices it from ``all_from`` on; None if there is none."""
        return share_noticed(len(self.counted)) if math.isfinite(self.all_from) else None

    @property
    def steps(self) -> tuple[MagnitudeStep, ...]:
        """What became of each magnitude."""
        sound = [one for one in self.rounds if not one.fails_without_fault]
        return tuple(_step(result, sound) for result in self.results)

    @property
    def violations(self) -> tuple[Violation, ...]:
        """Per round the smallest magnitude that was noticed below a larger one that was missed, if any."""
        rounds = (one for one in self.rounds if one.bracket.is_violated and not one.fails_without_fault)
        return tuple(
            Violation(one.number, one.bracket.out_of_order[0][0], one.bracket.out_of_order[-1][1])
            for one in rounds
        )

    @property
    def refused_from(self) -> float | None:
        """The smallest magnitude from which on a round knows nothing but refusals; None if none does."""
        ends = (one.bracket.refused for one in self.counted if one.bracket.high is None)
        return min((end for end in ends if end is not None), default=None)

    @property
    def runs(self) -> int:
        """How many (magnitude, round) were run, without magnitude 0."""
        return sum(len(one.outcomes) for one in self.rounds)

    @property
    def exhaustive(self) -> int:
        """How many there are."""
        return len(self.results) * len(self.rounds)

    @property
    def why_unjudged(self) -> str:
        """Why nothing is known of it; empty if something is."""
        if any(one.counts for one in self.rounds):
            return ""
        reasons = Counter(one.why_out for one in self.rounds)
        ranked = [
            f"{reason} ({count} of {len(self.rounds)} rounds)" for reason, count in reasons.most_common()
        ]
        return ranked[0].partition(" (")[0] if len(reasons) == 1 else "; ".join(ranked)

    def number_of(self, magnitude: float) -> int | None:
        """The number of the mutant of this magnitude; None if the ladder has none."""
        found = (one.mutant for one in self.results if is_same(one.mutant.magnitude or 0.0, magnitude))
        return next((one.number for one in found), None)

    def above(self, magnitude: float) -> float | None:
        """The next larger magnitude; None if there is none."""
        return next((size for size in self.sizes if size > magnitude), None)

    def are_neighbours(self, low: float, high: float) -> bool:
        """Whether no magnitude lies between these two of its own; 0 stands below the smallest."""
        return any(is_same(one, low) and is_same(two, high) for one, two in pairwise((0.0, *self.sizes)))


def looseness(ladder: Ladder) -> tuple[float, float, float, str]:
    """Greater for ladders whose faults may be larger before all rounds notice them.

    Magnitudes of different units are compared in those of the SI: a milliradian counts as a millimetre, which
    it is at a metre's reach.
    """
    factor = UNITS[ladder.unit].factor if ladder.unit in UNITS else 1.0
    ends = (ladder.all_from, ladder.half_from, ladder.none_up_to)
    first, second, third = (end * factor for end in ends)
    return first, second, third, ladder.id


def ladders_of(results: Results) -> tuple[Ladder, ...]:
    """The ladders of a campaign, in the order of its plan."""
    found: dict[str, list[MutantResult]] = {}
    for one in results.graded:
        found.setdefault(one.mutant.ladder, []).append(one)
    return tuple(_ladder(name, those, results.rounds) for name, those in found.items() if any(_sized(those)))


def _sized(results: Iterable[MutantResult]) -> Iterator[MutantResult]:
    return (one for one in results if one.mutant.magnitude)


def _ladder(name: str, results: Sequence[MutantResult], rounds: int) -> Ladder:
    rising = tuple(sorted(_sized(results), key=lambda one: one.mutant.magnitude or 0.0))
    zero = next((one for one in results if one.mutant.magnitude == 0.0), None)
    sizes = [one.mutant.magnitude or 0.0 for one in rising]

    def at(number: int) -> LadderRound:
        pairs = ((size, one.rounds[number]) for size, one in zip(sizes, rising, strict=True))
        outcomes: dict[float, Outcome] = {size: outcome for size, outcome in pairs if outcome is not None}
        return LadderRound.of(number, sizes, outcomes, zero.rounds[number] if zero is not None else None)

    return Ladder(name, rising, zero, tuple(at(number) for number in range(rounds)))


def _order(one: LadderRound) -> tuple[float, float, int]:
    high = one.bracket.high
    return math.inf if high is None else high, one.bracket.low or 0.0, one.number


def _step(result: MutantResult, rounds: Sequence[LadderRound]) -> MagnitudeStep:
    size = result.mutant.magnitude or 0.0
    outcomes = [one.outcomes[size] for one in rounds if size in one.outcomes]
    kinds = Counter(seen(one) for one in outcomes)
    return MagnitudeStep(
        magnitude=size,
        number=result.mutant.number,
        by=Counter(by for by in map(noticer, outcomes) if by is not None),
        missed=kinds[MagnitudeResult.MISSED],
        refused=kinds[MagnitudeResult.REFUSED],
        unknown=kinds[MagnitudeResult.UNKNOWN],
    )
