"""What a few rounds say about all: exact intervals, without any shape being assumed.

The thresholds of R rounds are taken as independent draws. How many of them lie below the median is then a
binomial number, whatever their distribution is, so that two of them, in order, hold the median between them
with a known probability. As each is known only as a bracket, the interval goes from the lower end of one to
the upper end of the other, which can only widen it. Measured by ``benchmarks/threshold_coverage.py``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from mutabot.analysis.statistics import LEVEL, Interval
from mutabot.frozen import frozen

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
