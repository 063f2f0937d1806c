"""A check that could be added: what it looks at, what it expects, whom it notices.

How far a reading may be from what the original reads comes from what it read in n runs, in one of three ways,
by what the runs look like; which one it was is told with the check.

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
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from statistics import NormalDist, fmean
from typing import Any, TypeGuard

from mutabot.frozen import frozen
from mutabot.results.ladders import lower_limit
from mutabot.suggestion.measure import Read
from mutabot.suggestion.readings import WAY, Reading
from mutabot.suggestion.style import Addition, Place, equal, within

#: of all runs of the original, how many the band holds, and how sure that is
CONTENT, CONFIDENCE = 0.99999, 0.95
NORMAL, FREE, SAME = "normal", "distribution-free", "always the same"
#: significance under which a spread is not taken to be normal, and the runs that need to be there to ask
_SIGNIFICANT, _LEAST = 0.05, 8
_STANDARD = NormalDist()


@frozen
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
    return 1 - lower_limit(count - 1, count, CONFIDENCE)


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


#: longest line that is written where it can be parted
_WIDTH = 90
_NAME = re.compile(r"[^\W\d]\w*")


@frozen
class Expected:
    """What a reading is held against.

    Attributes:
        values: what is expected: by the label's value, or by None where nothing else decides.
        label: expression by which it is looked up; None if there is one value.
        minus: expression that is taken off before.
        band: how far it may be off; None if it must be equal.
        runs: how many runs of the original agree.
    """

    values: Mapping[Any, Any]
    runs: int
    label: str | None = None
    minus: str | None = None
    band: Band | None = None

    def margin(self, text: str, read: Read) -> float:
        """How far a run is from it, in tolerances: above 1 is outside. 0 where it cannot be told."""
        found = read.get(text)
        key = read.get(self.label) if self.label is not None else None
        if text not in read or (self.label is not None and key not in self.values):
            return 0.0
        expected = self.values[key]
        if self.band is None:
            return 0.0 if found == expected and type(found) is type(expected) else 2.0
        other = read.get(self.minus) if self.minus is not None else 0.0
        if not (is_number(found) and is_number(other)):
            return 0.0
        return float(abs(found - other - expected)) / self.band.tolerance


@dataclass(frozen=True, eq=False)
class Check:
    """A check at the end of a test.

    Attributes:
        place: the test.
        reading: what it reads.
        expected: what it expects.
        margins: mutant id to round to how far it is outside, in tolerances; only what it would notice.
        needs: imports of what it uses beside its reading.
    """

    place: Place
    reading: Reading
    expected: Expected
    margins: Mapping[str, Mapping[int, float]] = field(default_factory=dict)
    needs: tuple[str, ...] = ()

    @property
    def trials(self) -> frozenset[tuple[str, int]]:
        """The mutants and rounds that it would notice."""
        return frozenset((mutant, round) for mutant, rounds in self.margins.items() for round in rounds)

    @property
    def margin(self) -> float:
        """How far outside the least of them is."""
        return min((margin for rounds in self.margins.values() for margin in rounds.values()), default=0.0)

    @property
    def looked_at(self) -> str:
        """The expression that it holds against what it expects."""
        minus = self.expected.minus
        return self.reading.expression + (f" - {minus}" if minus is not None else "")

    @property
    def lines(self) -> tuple[str, ...]:
        """It in the style of its test: the assertion is the last of them."""
        style, band, label = self.place.style, self.expected.band, self.expected.label
        texts = {key: self._text(value) for key, value in self.expected.values.items()}
        head: tuple[str, ...] = ()
        value = "expected"
        if label is None:
            value = texts[None]
        else:
            head = _looked_up([f"{literal(key)}: {text}" for key, text in texts.items()], label)
        if band is None:
            return *head, equal(style, self.looked_at, value)
        return *head, within(style, self.looked_at, value, decimal(band.tolerance))

    @property
    def statement(self) -> str:
        """The assertion."""
        return self.lines[-1]

    def _text(self, value: Any) -> str:
        if self.reading.way == WAY and self.expected.band is None:
            return str(value)  # a list, as it was noted
        return decimal(value) if self.expected.band is not None else literal(value)

    def addition(self) -> Addition:
        """It as something that is added to a test."""
        names = set(_NAME.findall(" ".join(self.lines)))
        approx = ["import pytest"] if "pytest.approx" in self.statement else []
        return Addition(
            self.place,
            self.lines,
            tuple(name for name in self.place.names if name in names),
            (*self.reading.needs, *self.needs, *approx),
            self.reading.watch,
        )


def _looked_up(pairs: list[str], label: str) -> tuple[str, ...]:
    """What is expected by a label, in one line or in one per value."""
    line = f"expected = {{{', '.join(pairs)}}}[{label}]"
    if len(line) <= _WIDTH:
        return (line,)
    return "expected = {", *(f"    {pair}," for pair in pairs), f"}}[{label}]"


def literal(value: Any) -> str:
    """A value as a text of a program."""
    text = repr(value)
    if isinstance(value, str) and '"' not in text and "\\" not in text:
        return f'"{value}"'
    return text


def is_number(value: Any) -> TypeGuard[float]:
    """Whether a value is one that can be near another."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
