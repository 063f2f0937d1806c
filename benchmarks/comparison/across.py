"""Numbers across tasks: suites of three strengths, differences of families, ranks of operators.

A suite's score is over the outcomes that the campaign of all tests counts: what that refuses or leaves out as
without effect is outside for each suite. A suite holds the weaker ones, so its score is never below theirs;
what is to be found out is by how much it is above.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from statistics import correlation, fmean, stdev
from typing import Any

from mutabot.results.statistics import Interval, crossed

from .ends import End

Mutant = Mapping[str, Any]
STRENGTHS = ("weak", "medium", "strong")
#: noticed, but by which suite first is not known: the process ended in a test of another suite
UNKNOWN = "unknown"
ALL = (*STRENGTHS, "all", UNKNOWN)
#: ends of outcomes that count in the score
VALID = frozenset(
    {
        End.CHECK, End.EXCEPTION, End.BEFORE, End.TIMEOUT, End.SURVIVED, End.NOT_COVERED,
        End.INDISTINGUISHABLE,
    }
)  # fmt: skip
#: Student's t at 97.5 % for 1, 2, … degrees of freedom
_STUDENT = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228)
_NORMAL = 1.960
#: of the rank correlation's variance (Fieller, Hartley and Pearson, Biometrika 44, 1957)
_FIELLER = 1.06


def cells(mutants: Iterable[Mutant], strengths: Sequence[str]) -> list[list[float | None]]:
    """By mutant and round, whether the weakest suite that notices is one of these.

    None outside the score, and where that is not known.
    """
    return [
        [
            _cell(end, noticed, strengths)
            for end, noticed in zip(mutant["ends"], mutant["noticed"], strict=True)
        ]
        for mutant in mutants
    ]


def _cell(end: str, noticed: str | None, strengths: Sequence[str]) -> float | None:
    if End(end) not in VALID or (noticed == UNKNOWN and UNKNOWN not in strengths):
        return None
    return float(noticed in strengths)


def scores(mutants: Sequence[Mutant], strength: str) -> list[tuple[int, int]]:
    """Killed and valid in each round, by the suite of a strength and the weaker ones beside it."""
    table = cells(mutants, STRENGTHS[: STRENGTHS.index(strength) + 1])
    rounds = [[cell for cell in column if cell is not None] for column in zip(*table, strict=True)]
    return [(round(sum(column)), len(column)) for column in rounds]


def alone(mutants: Sequence[Mutant], strength: str) -> tuple[int, int, Interval | None]:
    """Outcomes that this suite notices and no weaker one, how many count, and the interval of the share."""
    table = cells(mutants, [strength])
    counted = [cell for row in table for cell in row if cell is not None]
    return round(sum(counted)), len(counted), crossed(table)


def is_ordered(mutants: Sequence[Mutant]) -> bool:
    """Whether in every round the strong suite kills more than the medium one, and that more than the weak."""
    killed = [[count for count, _ in scores(mutants, strength)] for strength in STRENGTHS]
    return all(weak < medium < strong for weak, medium, strong in zip(*killed, strict=True))


def by_operator(mutants: Iterable[Mutant]) -> dict[str, list[Mutant]]:
    """The mutants of each operator."""
    found: dict[str, list[Mutant]] = defaultdict(list)
    for mutant in mutants:
        found[mutant["operator"]].append(mutant)
    return dict(found)


def operator_scores(mutants: Iterable[Mutant], least: int) -> dict[str, float]:
    """Share of the counting outcomes that all tests together notice, of operators with so many mutants."""
    found = {}
    for operator, those in by_operator(mutants).items():
        table = [row for row in cells(those, ALL) if any(cell is not None for cell in row)]
        if len(table) >= least:
            found[operator] = fmean(cell for row in table for cell in row if cell is not None)
    return found


def mean_over_tasks(values: Sequence[float]) -> tuple[float, float, float] | None:
    """Mean with its 95 % interval over tasks like these (Student's t); None with less than two."""
    if not 2 <= len(values) <= len(_STUDENT) + 1:
        return None
    middle = fmean(values)
    half = _STUDENT[len(values) - 2] * stdev(values) / math.sqrt(len(values))
    return middle, middle - half, middle + half


def rank_correlation(first: Sequence[float], second: Sequence[float]) -> tuple[float, Interval | None] | None:
    """Spearman's, ties with their mean rank, and its 95 % interval.

    None if either has no two different values. No interval with less than five pairs or where all agree.
    """
    if len(first) < 2 or len({*first}) == 1 or len({*second}) == 1:
        return None
    rho = correlation(_ranks(first), _ranks(second))
    if len(first) < 5 or abs(rho) > 1 - 1e-9:
        return rho, None
    half = _NORMAL * math.sqrt(_FIELLER / (len(first) - 3))
    return rho, Interval(math.tanh(math.atanh(rho) - half), math.tanh(math.atanh(rho) + half))


def _ranks(values: Sequence[float]) -> list[float]:
    ordered = sorted(values)
    return [ordered.index(value) + (ordered.count(value) - 1) / 2 for value in values]
