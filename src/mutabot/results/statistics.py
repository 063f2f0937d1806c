"""Confidence intervals of kill rates and scores, over other rounds and other mutants like these.

``wilson`` is for one mutant: its rounds are independent draws. ``crossed`` is for a score: every cell of the
table mutants × rounds shares its mutant with a row and its round with a column, so cells are not independent
and a plain binomial interval would be far too narrow (rounds of one mutant mostly agree). ``sampled`` is for
the score of a finite list of mutants of which only a random sample was run, in these very rounds.

All are tested by simulation, see ``benchmarks/interval_coverage.py`` and docs/statistics.md.

How many kills and survivors are false, estimated from those that were run once more.

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
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise, takewhile
from statistics import NormalDist, fmean

from mutabot.frozen import frozen
from mutabot.journal.records import LET_THROUGH, Repeated, Repeats, is_wrong, run_short
from mutabot.model import Outcome, Verdict
from mutabot.thresholds.ladders import LEVEL

_NORMAL = NormalDist().inv_cdf(0.5 + LEVEL / 2)
#: weight of the one killed and the one surviving mutant that are imagined when the spread of mutants is
#: estimated; without them, a single odd outcome among equal ones makes the interval far too narrow
_IMAGINED = 0.1
#: degrees of freedom, and how many standard errors an interval of LEVEL reaches to each side: Student's t at
#: 97.5 %, as NIST's handbook of statistical methods lists it (1.3.6.7.2), with a digit more
_STUDENT = (
    (1.0, 12.7062), (1.25, 8.0280), (1.5, 6.0167), (1.75, 4.9488), (2.0, 4.3027), (2.5, 3.5747),
    (3.0, 3.1824), (4.0, 2.7764), (5.0, 2.5706), (6.0, 2.4469), (8.0, 2.3060), (12.0, 2.1788),
    (20.0, 2.0860), (40.0, 2.0211), (math.inf, 1.9600),
)  # fmt: skip


@frozen
class Interval:
    """A confidence interval of a share.

    Attributes:
        low, high: its ends, 0 … 1.
        level: how often such an interval holds the true share.
    """

    low: float
    high: float
    level: float = LEVEL


def wilson(killed: float, valid: float) -> Interval | None:
    """Wilson's score interval of a share; None without observations.

    For a mutant's kill rate k/n. Assumes that its rounds are drawn independently and alike, and speaks about
    further rounds of this one mutant.
    """
    if valid <= 0:
        return None
    return _wilson(killed / valid, valid)


def crossed(table: Sequence[Sequence[float | None]]) -> Interval | None:
    """Return the interval of a score over rounds and mutants, both taken as random samples.

    The score is the mean over rounds of killed / valid. The interval is Wilson's, with the number of
    independent observations that gives the score's estimated variance, and Student's t in place of the
    normal quantile. With M mutants, R rounds and the mean squares of a two-way analysis of variance, that
    variance is

        V = MSm / MR + max(0, MSr − MSe) / MR

    (mutants; rounds beyond what chance within cells explains). The degrees of freedom are Satterthwaite's,
    with M − 1 for the first term, and for the second those of MSr / MR on R − 1: a round effect that is
    estimated from five rounds is uncertain, and t says so. V is what the two-way ("pigeonhole") bootstrap
    over rounds and mutants is after, without its bias and its noise. Cells without a valid outcome (None)
    are left out; V is then that of the linearised score.

    Assumes that mutants are exchangeable among themselves, and rounds likewise. Speaks about a long series of
    rounds with mutants of which these are a sample.

    Args:
        table: one row per mutant with one cell per round: 1 for killed, 0 for not killed, None for not valid.

    Returns:
        The interval, or None with fewer than two rounds or two mutants: then it is unknown how they differ.
    """
    cells = _Cells.of(table)
    if cells is None:
        return None
    return cells.interval(*cells.variance(), most=cells.count)


def sampled(table: Sequence[Sequence[float | None]], population: int) -> Interval | None:
    """Return the interval of the score that *all* mutants would have had, from a random sample of them.

    The rounds are given: it is the score of the same campaign without sampling. As in ``crossed``, the
    interval is Wilson's with the number of independent observations that gives the score's estimated
    variance, here of simple random sampling without replacement,

        V = (1 − n/N) MSm / MR

    with n of N mutants drawn, the score linearised where cells are missing, and Student's t with n − 1
    degrees of freedom (Cochran, "Sampling Techniques", 1977: chapter 2 for the finite population, chapter 6
    for the ratio, since only the run shows which of the drawn mutants are valid). It is never narrower than
    if each valid mutant had been decided by one throw: a sample in which all mutants are nearly alike has
    often missed the few that are not. When n = N the sample is all there is, and the interval is the score
    alone.

    Args:
        table: one row per drawn mutant, as for ``crossed``; also those that were never valid.
        population: how many mutants the sample was drawn from.

    Returns:
        The interval, or None with fewer than two mutants that were valid in any round.
    """
    cells = _Cells.of(table, least_rounds=1)
    if cells is None:
        return None
    left = max(0.0, 1 - len(table) / population)
    if left == 0.0:
        return Interval(cells.score, cells.score)
    variance = left * cells.variance_of_mutants()
    return cells.interval(variance, cells.mutants - 1, most=cells.mutants / left)


@frozen
class _Cells:
    """The valid cells of a table of mutants by rounds.

    Attributes:
        rows: one mapping from round to 0 … 1 per mutant.
        rounds: share killed per round.
        sizes: number of valid mutants per round.
    """

    rows: Sequence[Mapping[int, float]]
    rounds: Mapping[int, float]
    sizes: Mapping[int, int]

    @classmethod
    def of(cls, table: Sequence[Sequence[float | None]], *, least_rounds: int = 2) -> _Cells | None:
        rows = [
            {number: value for number, value in enumerate(row) if value is not None}
            for row in table
            if any(value is not None for value in row)
        ]
        columns: dict[int, list[float]] = {}
        for row in rows:
            for number, value in row.items():
                columns.setdefault(number, []).append(value)
        if len(rows) < 2 or len(columns) < least_rounds:
            return None
        means = {number: fmean(values) for number, values in columns.items()}
        return cls(rows, means, {number: len(values) for number, values in columns.items()})

    @property
    def mutants(self) -> int:
        return len(self.rows)

    @property
    def count(self) -> int:
        return sum(self.sizes.values())

    @property
    def score(self) -> float:
        return fmean(self.rounds.values())

    @property
    def smoothed(self) -> float:
        """The score with the pseudo-mutants included."""
        return (self.score * self.mutants + _IMAGINED) / (self.mutants + 2 * _IMAGINED)

    def interval(self, variance: float, freedom: float, *, most: float) -> Interval:
        """Return Wilson's interval for as many observations as give this variance, at most ``most``."""
        independent = self.smoothed * (1 - self.smoothed) / variance * (_NORMAL / student(freedom)) ** 2
        return _wilson(self.score, min(independent, most))

    def weight(self, number: int) -> float:
        """Return the weight of a cell of this round in the score."""
        return 1.0 / (len(self.rounds) * self.sizes[number])

    def influence(self, row: Mapping[int, float]) -> float:
        """Return what a mutant contributes to the score beyond an average one."""
        return math.fsum(self.weight(number) * (value - self.rounds[number]) for number, value in row.items())

    def variance_of_mutants(self) -> float:
        """MSm / MR, with the imagined mutants: variance of the score if only the mutants were redrawn."""
        mutants, smoothed = self.mutants, self.smoothed
        squares = mutants**2 * math.fsum(self.influence(row) ** 2 for row in self.rows)
        squares += mutants * (self.score - smoothed) ** 2
        squares += _IMAGINED * (smoothed**2 + (1 - smoothed) ** 2)
        size = mutants + 2 * _IMAGINED
        return squares / (size * (size - 1))

    def variance(self) -> tuple[float, float]:
        """Return the variance of the score (V of ``crossed``) with its degrees of freedom."""
        of_mutants, of_rounds = self.variance_of_mutants(), self.mean_square_of_rounds()
        excess = max(0.0, of_rounds - self.variance_of_cells())
        variance = of_mutants + excess
        spread = of_mutants**2 / (self.mutants - 1)
        spread += of_rounds**2 / (len(self.rounds) - 1) if excess else 0.0
        return variance, max(1.0, variance**2 / spread)

    def mean_square_of_rounds(self) -> float:
        """MSr / MR: variance of the score if only the rounds were redrawn."""
        rounds, score = len(self.rounds), self.score
        return math.fsum((share - score) ** 2 for share in self.rounds.values()) / (rounds * (rounds - 1))

    def variance_of_cells(self) -> float:
        """MSe / MR: the variance that chance within cells alone gives."""
        free = self.count - self.mutants - len(self.rounds) + 1
        if free <= 0:
            return 0.0
        squares = 0.0
        for row in self.rows:
            shift = self.influence(row) / math.fsum(self.weight(number) for number in row)
            for number, value in row.items():
                squares += (self.weight(number) * (value - self.rounds[number] - shift)) ** 2
        return squares * self.count / free


def student(freedom: float) -> float:
    """Return the half-width of an interval of ``LEVEL`` in standard errors, from 1 degree of freedom on.

    Between the lines of the table ``ln t`` is taken as linear in 1/freedom: within 0.4 %, and within 0.05 %
    from 4 on. Raises ValueError below 1.
    """
    if not freedom >= 1:
        raise ValueError(f"{freedom} degrees of freedom: there must be 1 or more")
    for (fewer, larger), (more, smaller) in pairwise(_STUDENT):
        if freedom <= more:
            part = (1 / fewer - 1 / freedom) / (1 / fewer - 1 / more)
            return float(larger ** (1 - part) * smaller**part)
    raise AssertionError("the table ends at infinity")


def _wilson(share: float, size: float) -> Interval:
    z, square = _NORMAL, _NORMAL**2
    middle = (share + square / (2 * size)) / (1 + square / size)
    half = z / (1 + square / size) * math.sqrt(share * (1 - share) / size + square / (4 * size * size))
    low, high = max(0.0, middle - half), min(1.0, middle + half)
    return Interval(low if share > 0 else 0.0, high if share < 1 else 1.0)  # which rounding may miss


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
    """Estimate how many of the kills that still count are false; None if no kill was repeated."""
    found = _sum_of((repeats.doubted, repeats.others), level)
    if found is None:
        return None
    changed = repeats.doubted.changed + repeats.others.changed
    confirmed = repeats.doubted.repeated + repeats.others.repeated - changed
    expected, most = confirmed_by_chance(changed, confirmed, repeats.survivors.outcomes, level)
    return Estimate(
        found.expected + expected, found.low, found.high + most, found.known, found.unknown, level
    )


def false_survivors(repeats: Repeats, level: float = LEVEL) -> Estimate | None:
    """Estimate how many of the survivors that still count would not survive again; None without repeats."""
    return _sum_of((repeats.survivors,), level)


def _sum_of(strata: tuple[Repeated, ...], level: float) -> Estimate | None:
    """Return the sum over kinds of outcomes. The ends are summed too, so the interval is conservative."""
    looked = [repeat for repeat in strata if repeat.repeated]
    if not looked:
        return None
    ends = [remaining(repeat, level) for repeat in looked]
    return Estimate(
        sum(repeat.changed / repeat.repeated * repeat.left for repeat in looked),
        sum(low for low, _ in ends),
        sum(high for _, high in ends),
        sum(repeat.outcomes - repeat.changed for repeat in looked),
        sum(repeat.outcomes for repeat in strata if not repeat.repeated),
        level,
    )


def remaining(stratum: Repeated, level: float = LEVEL) -> tuple[int, int]:
    """Return the interval of how many of the unrepeated outcomes would change.

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
    """Return the expected and greatest likely number of false kills that were confirmed by chance.

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
    """Return the probability that k of ``drawn`` outcomes are among the ``changed`` ones of ``total``."""
    if k > changed or drawn - k > total - changed or k > drawn or k < 0:
        return 0.0
    return math.exp(_log_comb(changed, k) + _log_comb(total - changed, drawn - k) - _log_comb(total, drawn))


def _log_comb(n: int, k: int) -> float:
    return math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)


def _last(holds: Callable[[int], bool], first: int, last: int) -> int:
    """Return the last number from ``first`` on for which ``holds`` is true; it changes at most once."""
    while first < last:
        middle = (first + last + 1) // 2
        first, last = (middle, last) if holds(middle) else (first, middle - 1)
    return first


@frozen
class Confirmed:
    """The whole suite's verdicts on mutants that ran without some of its tests.

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
        """Count these outcomes; None if no test was left out."""
        outcomes = list(outcomes)
        drawn = run_short(outcomes, seed)
        if not drawn:
            return None
        left = sum(not outcome.confirmed for outcome in drawn)
        let_through = [outcome for outcome in drawn if outcome.verdict in LET_THROUGH]
        whole = sum(outcome.verdict is Verdict.SURVIVED and outcome.confirmed is None for outcome in outcomes)
        sample = list(takewhile(lambda outcome: outcome.confirmed, drawn))
        found = Repeated(len(drawn), len(sample), sum(map(is_wrong, sample)))
        most = min(remaining(found, 2 * LEVEL - 1)[1], left) if sample else None  # one end of its interval
        refused = sum(outcome.verdict is Verdict.REFUSED for outcome in let_through)
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
