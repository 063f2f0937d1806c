"""How far a reading may be from what the original reads, from what it read in n runs.

Three ways, by what the runs look like; which one it was is told with the check.

* ``NORMAL``: the two-sided tolerance interval of a normal distribution: it holds a share ``CONTENT`` of all
  runs, with confidence ``CONFIDENCE``, as far as the spread is normal. Factor by Howe, "Two-sided tolerance
  limits for normal populations", JASA 64 (1969); chi-squared quantiles by Wilson and Hilferty, PNAS 17
  (1931). Whether the spread may be normal says the test of Shapiro and Francia with Royston's
  significance, Statistics and Computing 3 (1993).
* ``FREE``: the range of the runs, widened by itself on both sides, or more if a normal spread would ask for
  more. That the range alone holds a share of all runs is known whatever the distribution: Wilks, Ann. Math.
  Stat. 12 (1941).
* ``SAME``: every run read the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist, fmean

#: of all runs of the original, how many the band holds, and how sure that is
CONTENT, CONFIDENCE = 0.99999, 0.95
NORMAL, FREE, SAME = "normal", "distribution-free", "always the same"
#: significance under which a spread is not taken to be normal, and the runs that need to be there to ask
_SIGNIFICANT, _LEAST = 0.05, 8
_STANDARD = NormalDist()


@dataclass(frozen=True, slots=True)
class Band:
    """What a reading must stay within: the middle and the tolerance to each side.

    Attributes:
        tolerance: in the unit of the reading.
        spread: the greatest distance of two runs of the original that are to read alike.
        runs: how many runs of the original it comes from.
        kind: ``NORMAL``, ``FREE`` or ``SAME``.
        factor: multiples of the standard deviation, for a normal band.
        alarm: share of the runs of the original that may fall outside, at most.
    """

    tolerance: float
    spread: float
    runs: int
    kind: str
    factor: float | None
    alarm: float


def band_of(groups: Sequence[Sequence[float]], floor: float) -> tuple[list[float], Band]:
    """The middles of these groups of readings, and one band around each of them.

    Groups differ in their middles alone: their spread is taken together. ``floor`` is the least tolerance.
    """
    count = sum(len(group) for group in groups)
    smallest = min(len(group) for group in groups)
    spread = max(max(group) - min(group) for group in groups)
    middles = [fmean(group) for group in groups]
    rest = [value - middle for group, middle in zip(groups, middles, strict=True) for value in group]
    if spread <= 1e-9 * max(1.0, *(abs(value) for group in groups for value in group)):
        return middles, Band(floor, spread, count, SAME, None, unseen(count))
    freedom = max(1, count - len(groups))
    deviation = math.sqrt(sum(value * value for value in rest) / freedom)
    factor = tolerance_factor(smallest, freedom)
    if may_be_normal(rest):
        return middles, Band(max(floor, factor * deviation), spread, count, NORMAL, factor, 1.0 - CONTENT)
    middles = [(min(group) + max(group)) / 2 for group in groups]
    tolerance = max(floor, 1.5 * spread, factor * deviation)
    return middles, Band(tolerance, spread, count, FREE, None, outside_range(smallest))


def tolerance_factor(count: int, freedom: int) -> float:
    """Standard deviations to each side of a mean of ``count`` that hold ``CONTENT`` with ``CONFIDENCE``."""
    z = _STANDARD.inv_cdf(0.5 + CONTENT / 2)
    return z * math.sqrt(freedom * (1 + 1 / count) / chi_squared(1 - CONFIDENCE, freedom))


def chi_squared(probability: float, freedom: int) -> float:
    """The quantile of chi-squared; within 1 % from five degrees of freedom on."""
    part = 2 / (9 * freedom)
    return freedom * max(1e-3, 1 - part + _STANDARD.inv_cdf(probability) * math.sqrt(part)) ** 3


def may_be_normal(values: Sequence[float]) -> bool:
    """Whether these look like draws of one normal distribution, or at least not like anything else."""
    count = len(values)
    if count < _LEAST:
        return False
    scores = [_STANDARD.inv_cdf((number - 0.375) / (count + 0.25)) for number in range(1, count + 1)]
    ordered = sorted(values)
    mean = fmean(ordered)
    total = sum((value - mean) ** 2 for value in ordered) * sum(score * score for score in scores)
    if total <= 0:
        return False
    likeness = sum(score * value for score, value in zip(scores, ordered, strict=True)) ** 2 / total
    u = math.log(count)
    v = math.log(u)
    middle, scale = -1.2725 + 1.0521 * (v - u), 1.0308 - 0.26758 * (v + 2 / u)
    z = (math.log(max(1e-300, 1 - likeness)) - middle) / scale
    return 1 - _STANDARD.cdf(z) >= _SIGNIFICANT


def outside_range(count: int) -> float:
    """The share of all runs that may lie outside the range of ``count``, at most, with ``CONFIDENCE``."""
    if count < 2:
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(60):
        share = (low + high) / 2
        holds = 1 - count * share ** (count - 1) + (count - 1) * share**count
        low, high = (share, high) if holds > CONFIDENCE else (low, share)
    return 1 - low


def unseen(count: int) -> float:
    """The share of runs in which something may happen that did not in ``count``, with ``CONFIDENCE``."""
    return 1 - (1 - CONFIDENCE) ** (1 / count) if count else 1.0


def rounded(middle: float, tolerance: float) -> tuple[str, str]:
    """Both as texts: the tolerance rounded up to two digits, the middle a hundredth of it exact."""
    if tolerance <= 0:
        return repr(middle), "0.0"
    digits = 1 - math.floor(math.log10(tolerance))
    step = 10.0**-digits
    whole = math.ceil(tolerance / step - 1e-9) * step
    return decimal(round(middle, digits + 1)), decimal(round(whole, digits))


def decimal(value: float) -> str:
    """A number as a text of a program."""
    text = repr(float(value))
    return "0.0" if text == "-0.0" else text
