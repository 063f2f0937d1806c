"""The thresholds of a campaign: its ladders, what they cost, how wide the checks are; also of two of them.

A check |reading| ≤ T on a reading that is off by ε in a round notices faults above T − ε in one direction and
above T + ε in the other. So the half of the sum of both thresholds is T, however the rounds fell, and half of
their difference is the bias of the round.

Thresholds in words: what the rounds showed, as brackets and never as a number between them.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import NormalDist
from typing import Any

from mutabot.frozen import frozen
from mutabot.model import Quantity
from mutabot.model.graded import OFFSET, seen
from mutabot.model.units import UNITS, convert_difference
from mutabot.results.ladders import Above, Ladder, LadderRound, ladders_of, looseness
from mutabot.results.results import Results


def amount(magnitude: float, unit: str | None) -> str:
    """``20 mm``; a fraction in percent, a plain number without a unit."""
    if unit in ("fraction", "percent"):
        return f"{magnitude * (100 if unit == 'fraction' else 1):.6g} %"
    return f"{magnitude:.6g}{f' {unit}' if unit is not None else ''}"


def line_of(ladder: Ladder) -> str:
    """The line of a ladder that can be judged: a fact about these rounds."""
    brackets = {(one.bracket.low, one.bracket.high, one.above) for one in ladder.counted}
    if not any(one.is_reached for one in ladder.counted):
        return f"no test reaches it{_all(ladder)}"
    return _alike(ladder) if len(brackets) == 1 else _apart(ladder)


def rounds_left_out(ladder: Ladder) -> Iterator[str]:
    """Rounds that do not count although others do, each with the reason."""
    for one in ladder.rounds:
        if one.why_out:
            yield f"round {one.number + 1} {one.why_out}"


def _alike(ladder: Ladder) -> str:
    one = ladder.counted[0]
    low, high = one.bracket.low, one.bracket.high
    if high is None:
        return f"{_never(ladder, one)}{_all(ladder)}"
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
    """In how many rounds it is noticed from where: the first of them, half of them, all."""
    highs = [high for high in ladder.highs if math.isfinite(high)]
    wanted = {highs[0], highs[-1], ladder.half_from} if highs else set()
    for high in sorted(one for one in wanted if math.isfinite(one)):
        count = sum(one <= high for one in highs)
        yield count, _smallest(ladder, high) if high == ladder.sizes[0] else _text(ladder, high)


def _never_noticed(ladder: Ladder) -> Iterator[str]:
    """The rounds that never notice it, alike ones together."""
    rounds = [one for one in ladder.counted if one.bracket.high is None]
    total = len(ladder.counted)
    for text, count in Counter(_never(ladder, one) for one in rounds).items():
        yield f"{text} ({count} of {total} rounds)"


def _never(ladder: Ladder, one: LadderRound) -> str:
    low = one.bracket.low
    if not one.is_reached:
        return "no test reaches it"
    missed = f"not noticed up to {_text(ladder, low)}" if low is not None else ""
    above = ""
    if one.above is Above.REFUSED and one.bracket.refused is not None:
        above = f"refused from {_text(ladder, one.bracket.refused)}"
    elif one.above is Above.NO_EFFECT:
        above = "without effect above"
    return ", ".join(part for part in (missed, above) if part)


def _smallest(ladder: Ladder, high: float) -> str:
    return f"the smallest tried, {_text(ladder, high)}"


def _all(ladder: Ladder) -> str:
    """Of how many rounds something holds that holds of all."""
    total = len(ladder.counted)
    return f" (all {total} rounds)" if total > 1 else " (1 round)"


def _text(ladder: Ladder, magnitude: float) -> str:
    return amount(magnitude, ladder.unit)


def violations_in_words(ladder: Ladder) -> Iterator[str]:
    """``noticed at 5 mm, survives 20 mm, round 3``, one per violation; rounds alike together."""
    rounds: dict[tuple[float, float], list[int]] = {}
    for one in ladder.violations:
        rounds.setdefault((one.noticed, one.missed), []).append(one.round + 1)
    for (noticed, missed), numbers in rounds.items():
        yield (f"noticed at {_text(ladder, noticed)}, survives {_text(ladder, missed)}, {in_rounds(numbers)}")


def in_rounds(numbers: Iterable[int]) -> str:
    """``round 3`` or ``rounds 1, 2 and 5``; the numbers count from 1."""
    *rest, last = [str(number) for number in sorted(set(numbers))]
    return f"rounds {', '.join(rest)} and {last}" if rest else f"round {last}"


#: a check that is not wider than so many standard deviations fails now and then without a fault
_DEVIATIONS = 3.0


@frozen
class Pair:
    """Both directions of an offset in one round.

    Attributes:
        round: 0-based.
        half_width: between which values T lies; the upper end is infinite where one side is never noticed.
        bias: between which values the bias lies; infinite likewise.
    """

    round: int
    half_width: tuple[float, float]
    bias: tuple[float, float]


@frozen
class Floor:
    """Both directions of an offset.

    Attributes:
        up, down: the ladders.
        pairs: one per round in which both count.
        noise: standard deviation of the reading, in the ladders' unit; None if the vocabulary does not say.
    """

    up: Ladder
    down: Ladder
    pairs: tuple[Pair, ...]
    noise: float | None

    @property
    def blind(self) -> tuple[float, float]:
        """From the largest fault down to the largest up that some round may miss."""
        return -self.down.all_from, self.up.all_from

    @property
    def half_width(self) -> tuple[float, float]:
        """Between which values T lies, which is the same in all rounds."""
        low = max(one.half_width[0] for one in self.pairs)
        high = min(one.half_width[1] for one in self.pairs)
        return (low, high) if low < high else (min(one.half_width[0] for one in self.pairs), high)

    @property
    def is_below_noise(self) -> bool:
        """Whether the check is so narrow that its sensor's noise alone makes it fail now and then."""
        return self.noise is not None and self.half_width[1] < _DEVIATIONS * self.noise

    @property
    def false_alarms(self) -> float | None:
        """Share of readings that fail without a fault, at least; None if the noise is not known."""
        high = self.half_width[1]
        if self.noise is None or not math.isfinite(high):
            return None
        return 2.0 * (1.0 - NormalDist().cdf(high / self.noise))

    @property
    def blind_text(self) -> str:
        """``blind between −10 mm and +20 mm``."""
        low, high = self.blind
        return f"blind between {_end(low, self.up.unit, self.down)} and {_end(high, self.up.unit, self.up)}"

    @property
    def text(self) -> str:
        """``notices 1 mm, sensor noise 2 mm; passes only by its seed``."""
        notices = amount(min(self.up.highs[0], self.down.highs[0]), self.up.unit)
        noise = amount(self.noise or 0.0, self.up.unit)
        return f"notices {notices}, sensor noise {noise}; passes only by its seed"


def floors_of(ladders: Iterable[Ladder]) -> Iterator[Floor]:
    """The offsets that are known in both directions, in the order of the first of them."""
    found: dict[str, dict[str, Ladder]] = {}
    for one in ladders:
        if one.mutant.operator == OFFSET and one.mutant.direction and one.counted:
            found.setdefault(_both(one), {})[one.mutant.direction[-1]] = one
    for both in found.values():
        if both.keys() == {"+", "-"}:
            up, down = both["+"], both["-"]
            pairs = tuple(_pairs(up, down))
            if pairs:
                yield Floor(up, down, pairs, noise_of(up.quantity, up.unit))


def noise_of(quantity: Quantity | None, unit: str | None) -> float | None:
    """The standard deviation of a reading, in this unit; None if nothing says."""
    if quantity is None or quantity.repeatability is None or quantity.path.root is not None:
        return None
    if unit == quantity.unit or unit not in UNITS or quantity.unit not in UNITS:
        return quantity.repeatability if unit == quantity.unit else None
    try:
        return float(f"{convert_difference(quantity.repeatability, quantity.unit, unit):.12g}")
    except ValueError:  # a magnitude of another kind, such as a delay
        return None


def _both(ladder: Ladder) -> str:
    mutant = ladder.mutant
    moment = mutant.moment.text if mutant.moment is not None else ""
    axis = mutant.direction[:-1]
    names = (mutant.site.id, mutant.pattern, mutant.quantity, moment, mutant.unit, axis, mutant.operation)
    return "|".join(name or "" for name in names)


def _pairs(up: Ladder, down: Ladder) -> Iterator[Pair]:
    for one, other in zip(up.rounds, down.rounds, strict=True):
        if one.counts and other.counts:
            (low, high), (low_down, high_down) = _ends(one), _ends(other)
            width = (low + low_down) / 2.0, (high + high_down) / 2.0
            yield Pair(one.number, width, ((low - high_down) / 2.0, (high - low_down) / 2.0))


def _ends(one: LadderRound) -> tuple[float, float]:
    high = one.bracket.high
    return one.bracket.low or 0.0, math.inf if high is None else high


def _end(value: float, unit: str | None, ladder: Ladder) -> str:
    if math.isfinite(value):
        sign = "−" if value < 0 else "+"
        return f"{sign}{amount(abs(value), unit)}"
    sign = "−" if value < 0 else "+"
    return f"beyond {sign}{amount(max(ladder.lows), unit)}"


_Key = Callable[[Ladder], Any]
#: orders of the table; the first is the usual one
SORTS: Mapping[str, _Key] = {
    "loosest": lambda one: tuple(-end for end in looseness(one)[:3]),
    "place": lambda one: (one.mutant.site.span.file, one.mutant.site.span.line, one.mutant.site.span.column),
    "operator": lambda one: (one.mutant.operator, *(-end for end in looseness(one)[:3])),
}


@dataclass(frozen=True)
class Thresholds:
    """The thresholds of a campaign.

    Attributes:
        ladders: those of which something is known, in the order that was asked for.
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
    def runs(self) -> int:
        """How many (magnitude, round) were run, without magnitude 0."""
        return sum(one.runs for one in self.all)

    @property
    def exhaustive(self) -> int:
        """How many there are."""
        return sum(one.exhaustive for one in self.all)

    @property
    def controls(self) -> int:
        """How many runs of magnitude 0 there were."""
        return sum(1 for one in self._zeros)

    @property
    def false_alarms(self) -> int:
        """How many of these were noticed."""
        return sum(1 for one in self._zeros if one.fails_without_fault)

    @cached_property
    def floors(self) -> tuple[Floor, ...]:
        """Offsets that are known in both directions."""
        return tuple(floors_of(self.ladders))

    @property
    def most_violated(self) -> float | None:
        """Largest share of such ladders that may be out of order (95 %), where none of them is.

        None if one is, or if they are too few to say anything.
        """
        count = len(self.ladders)
        if any(one.violations for one in self.ladders) or count <= 3:
            return None
        return 3.0 / count

    @property
    def _zeros(self) -> list[LadderRound]:
        known = (one for ladder in self.all for one in ladder.rounds if one.zero is not None)
        return [one for one in known if one.zero is not None and seen(one.zero).is_valid]


def thresholds_of(results: Results, sort: str = "loosest") -> Thresholds:
    """The thresholds of a campaign; ``sort`` is one of ``SORTS``."""
    ladders = ladders_of(results)
    judged = [one for one in ladders if not one.why_unjudged]
    return Thresholds(
        ladders=_sorted(judged, sort),
        unjudged=tuple(one for one in ladders if one.why_unjudged),
        rounds=results.rounds,
        state=results.state,
    )


def _sorted(ladders: Sequence[Ladder], sort: str) -> tuple[Ladder, ...]:
    return tuple(sorted(ladders, key=SORTS[sort]))
