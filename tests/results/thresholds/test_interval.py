"""Intervals of thresholds and rates: exact, and never narrower than they promise."""

from __future__ import annotations

import math
from random import Random
from statistics import NormalDist

import pytest

from mutabot.thresholds.brackets import MagnitudeResult, bracket_of
from mutabot.thresholds.ladders import (
    median_between,
    ranks,
    share_noticed,
)

LADDER = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)


@pytest.mark.parametrize(
    ("rounds", "found"),
    [
        *((rounds, None) for rounds in (1, 2, 3, 4, 5)),
        *((rounds, (1, rounds)) for rounds in (6, 7, 8)),
        (9, (2, 8)), (10, (2, 9)), (12, (3, 10)), (15, (4, 12)),
        (20, (6, 15)), (30, (10, 21)), (50, (18, 33)),
    ],
)  # fmt: skip
def test_the_ranks_are_those_of_the_tables(rounds: int, found: tuple[int, int] | None) -> None:
    assert ranks(rounds) == found


@pytest.mark.parametrize(("rounds", "level"), [(2, 0.5), (3, 0.75), (5, 0.9375), (6, 0.96875)])
def test_few_rounds_give_the_level_that_they_have(rounds: int, level: float) -> None:
    found = median_between([1.0] * rounds, [2.0] * rounds)
    assert found is not None
    assert found.level == pytest.approx(level)


def test_one_round_gives_no_interval() -> None:
    assert median_between([1.0], [2.0]) is None


@pytest.mark.parametrize(("rounds", "share"), [(3, 0.37), (5, 0.55), (10, 0.74), (29, 0.90), (59, 0.95)])
def test_what_all_rounds_notice_shows_a_share(rounds: int, share: float) -> None:
    assert share_noticed(rounds) == pytest.approx(share, abs=0.005)


@pytest.mark.parametrize("rounds", [3, 5, 10, 20])
@pytest.mark.parametrize("deviation", [0.0005, 0.1, 0.25])
def test_the_interval_holds_the_median_as_often_as_it_promises(rounds: int, deviation: float) -> None:
    """How often the interval covers the median, in a few simulated campaigns."""
    random, held, campaigns = Random(5), 0, 400
    level = 0.0
    for _ in range(campaigns):
        middle = random.uniform(math.log10(2.0), math.log10(20.0))
        thresholds = [10 ** random.gauss(middle, deviation) for _ in range(rounds)]
        brackets = [
            bracket_of(
                {size: MagnitudeResult.NOTICED if size >= at else MagnitudeResult.MISSED for size in LADDER}
            )
            for at in thresholds
        ]
        found = median_between(
            [bracket.low or 0.0 for bracket in brackets],
            [math.inf if bracket.high is None else bracket.high for bracket in brackets],
        )
        assert found is not None
        level = found.level
        held += found.low < 10**middle <= found.high
    slack = NormalDist().inv_cdf(0.999) * math.sqrt(level * (1 - level) / campaigns)
    assert held / campaigns >= level - slack
