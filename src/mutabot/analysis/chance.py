"""How many kills and survivors are false, estimated from those that were run once more.

An outcome that ended otherwise when it was repeated is unstable and does not count any more. What may still
be wrong is of two kinds: outcomes that were not repeated, and false kills that came out twice by chance.

The repeated outcomes of a kind are taken as a random sample of it. Then the number that would have changed,
had all been repeated, has an exact interval from the hypergeometric distribution. A false kill, of a mutant
that survives unless a test fails at random, is confirmed with the probability that such a failure comes
again: the number confirmed for each that was not has a negative binomial distribution.

Survivors that were run with the whole suite as well are the first ones in a random order, so a random sample.
The number that it would notice among the others has an exact upper limit from the same distribution.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from itertools import takewhile

from mutabot.frozen import frozen
from mutabot.journal.records import LET_THROUGH, Repeated, Repeats, is_wrong, run_short
from mutabot.model import Outcome, Verdict

from .statistics import LEVEL


@frozen
class Estimate:
    """An estimated number of outcomes.

    Attributes:
        expected: the estimate.
        low, high: ends of its interval.
        level: how often such an interval holds the true number, at least.
        known: of how many outcomes it speaks.
        unknown: outcomes of a kind of which none was repeated: nothing is known about them.
    """

    expected: float
    low: int
    high: int
    known: int
    unknown: int
    level: float = LEVEL


def false_kills(repeats: Repeats, level: float = LEVEL) -> Estimate | None:
    """How many of the kills that still count are false; None where no kill was repeated."""
    found = _together((repeats.doubted, repeats.others), level)
    if found is None:
        return None
    changed = repeats.doubted.changed + repeats.others.changed
    confirmed = repeats.doubted.repeated + repeats.others.repeated - changed
    expected, most = confirmed_by_chance(changed, confirmed, repeats.survivors.outcomes, level)
    return Estimate(
        found.expected + expected, found.low, found.high + most, found.known, found.unknown, level
    )


def false_survivors(repeats: Repeats, level: float = LEVEL) -> Estimate | None:
    """How many of the survivors that still count would not survive again; None where none was repeated."""
    return _together((repeats.survivors,), level)


def _together(strata: tuple[Repeated, ...], level: float) -> Estimate | None:
    """The sum over kinds of outcomes. The ends are summed too, which makes the interval rather too wide."""
    looked = [one for one in strata if one.repeated]
    if not looked:
        return None
    ends = [remaining(one, level) for one in looked]
    return Estimate(
        sum(one.changed / one.repeated * one.left for one in looked),
        sum(low for low, _ in ends),
        sum(high for _, high in ends),
        sum(one.outcomes - one.changed for one in looked),
        sum(one.outcomes for one in strata if not one.repeated),
        level,
    )


def remaining(stratum: Repeated, level: float = LEVEL) -> tuple[int, int]:
    """The interval of how many of the outcomes that were not repeated would change.

    Exact, as Clopper and Pearson's, but for a random sample without replacement: the numbers for which
    neither as few nor as many changed ones among the repeated are less likely than half of 1 − level.
    """
    total, drawn, seen = stratum.outcomes, stratum.repeated, stratum.changed
    tail = (1 - level) / 2
    most = total - (drawn - seen)

    def at_most(changed: int) -> float:
        return sum(_hypergeometric(k, total, changed, drawn) for k in range(seen + 1))

    def at_least(changed: int) -> float:
        return 1.0 - sum(_hypergeometric(k, total, changed, drawn) for k in range(seen))

    high = _last(lambda changed: at_most(changed) > tail, seen, most)
    low = seen if at_least(seen) > tail else _last(lambda n: at_least(n) <= tail, seen, high) + 1
    return low - seen, high - seen


def confirmed_by_chance(
    changed: int, confirmed: int, survivors: int, level: float = LEVEL
) -> tuple[float, int]:
    """Expected and greatest likely number of false kills that came out again by chance.

    Args:
        changed: kills that did not come out again.
        confirmed: kills that did.
        survivors: mutants that survived, so no test failed at random for them.
        level: nominal coverage.
    """
    if not changed or not confirmed:
        return 0.0, 0
    tail = (1 - level) / 2
    tried = survivors + 2 * changed  # a changed kill has failed once and passed once
    again = _binomial_upper(changed, tried, tail)
    expected = changed * changed / (tried - changed)
    likely, most = 0.0, -1
    while likely < 1 - tail and most < confirmed:
        most += 1
        likely += math.exp(
            _log_comb(most + changed - 1, most) + changed * math.log1p(-again) + most * math.log(again)
        )
    return min(expected, float(confirmed)), most


def _binomial_upper(seen: int, tried: int, tail: float) -> float:
    """Clopper and Pearson's upper end for a probability; ``seen`` is less than ``tried``."""
    low, high = seen / tried, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        odds, none = math.log(middle) - math.log1p(-middle), tried * math.log1p(-middle)
        at_most = sum(math.exp(_log_comb(tried, k) + k * odds + none) for k in range(seen + 1))
        low, high = (middle, high) if at_most > tail else (low, middle)
    return high


def _hypergeometric(k: int, total: int, changed: int, drawn: int) -> float:
    """The probability that k of ``drawn`` outcomes are among the ``changed`` ones of ``total``."""
    if k > changed or drawn - k > total - changed or k > drawn or k < 0:
        return 0.0
    return math.exp(_log_comb(changed, k) + _log_comb(total - changed, drawn - k) - _log_comb(total, drawn))


def _log_comb(n: int, k: int) -> float:
    return math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)


def _last(holds: Callable[[int], bool], first: int, last: int) -> int:
    """The last number from ``first`` on for which something holds that stops holding once at most."""
    while first < last:
        middle = (first + last + 1) // 2
        first, last = (middle, last) if holds(middle) else (first, middle - 1)
    return first


@frozen
class Confirmed:
    """What the whole suite says of mutants that were run without some of its tests.

    Attributes:
        outcomes: survivors, in all rounds, and what was refused while tests were left out.
        refused: how many of them were refused.
        confirmed: how many of them the whole suite lets through.
        wrong: how many more it noticed.
        left: how many were not run with it.
        most: how many of these it would notice at most; None if none was run with it.
        level: how often such a limit holds.
    """

    outcomes: int
    refused: int
    confirmed: int
    wrong: int
    left: int
    most: int | None
    level: float = LEVEL

    @classmethod
    def of(cls, outcomes: Iterable[Outcome], seed: int) -> Confirmed | None:
        """Of these outcomes; None if no test was left out."""
        outcomes = list(outcomes)
        drawn = run_short(outcomes, seed)
        if not drawn:
            return None
        left = sum(not one.confirmed for one in drawn)
        let_through = [one for one in drawn if one.verdict in LET_THROUGH]
        whole = sum(one.verdict is Verdict.SURVIVED and one.confirmed is None for one in outcomes)
        sample = list(takewhile(lambda one: one.confirmed, drawn))
        found = Repeated(len(drawn), len(sample), sum(map(is_wrong, sample)))
        most = min(remaining(found, 2 * LEVEL - 1)[1], left) if sample else None  # one end of its interval
        refused = sum(one.verdict is Verdict.REFUSED for one in let_through)
        all = whole + len(let_through)
        return cls(all, refused, all - left, sum(map(is_wrong, drawn)), left, most)

    @property
    def text(self) -> str:
        """``40 of 120 survivors confirmed by the whole suite, none was wrong: at most …``."""
        what = "survivors and refused mutants" if self.refused else "survivors"
        text = f"{self.confirmed} of {self.outcomes} {what} confirmed by the whole suite"
        if self.left and self.most is None:
            return f"{text}; how many of the others are wrong is not known"
        text += f", which notices {self.wrong} more" if self.wrong else ", none was wrong"
        if not self.left or self.most is None:
            return text
        share, level = math.ceil(100 * self.most / self.left), round(100 * self.level)
        return f"{text}: at most {share} % of the others, {level} %"
