"""Ladders: all magnitudes of one fault at one site, quantity, operator and direction, over all rounds."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

from mutabot.analysis.results import MutantResult, Results
from mutabot.analysis.statistics import Interval
from mutabot.frozen import frozen
from mutabot.model import Mutant, Outcome, Quantity
from mutabot.model.graded import OFFSET, Seen, is_same, seen
from mutabot.model.values.units import UNITS

from .interval import Between, exact, median_between, share_noticed
from .rounds import LadderRound, noticer

_SIGNS = {"+": "+", "-": "−"}


@frozen
class Step:
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
class Better:
    """A fault with which a test did better than without, by a figure of merit that the vocabulary names.

    Attributes:
        round: 0-based round.
        magnitude: of the fault, in the ladder's unit.
        text: which figure, and by how much.
    """

    round: int
    magnitude: float
    text: str


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
    def steps(self) -> tuple[Step, ...]:
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
    def better(self) -> tuple[Better, ...]:
        """Where a test did better with the fault than without."""
        return tuple(
            Better(one.number, size, outcome.improvement)
            for one in self.rounds
            for size, outcome in one.outcomes.items()
            if outcome.improvement
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


def _step(result: MutantResult, rounds: Sequence[LadderRound]) -> Step:
    size = result.mutant.magnitude or 0.0
    outcomes = [one.outcomes[size] for one in rounds if size in one.outcomes]
    kinds = Counter(seen(one) for one in outcomes)
    return Step(
        magnitude=size,
        number=result.mutant.number,
        by=Counter(by for by in map(noticer, outcomes) if by is not None),
        missed=kinds[Seen.MISSED],
        refused=kinds[Seen.REFUSED],
        unknown=kinds[Seen.UNKNOWN],
    )
