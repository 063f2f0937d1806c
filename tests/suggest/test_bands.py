"""Bands hold what they say, and the cover is the smallest there is."""

from __future__ import annotations

import random
from itertools import combinations
from statistics import NormalDist, fmean, stdev

import pytest

from mutabot.suggest.checks import (
    CONFIDENCE,
    FREE,
    NORMAL,
    SAME,
    band_of,
    may_be_normal,
    outside_range,
    rounded,
    tolerance_factor,
    unseen,
)
from mutabot.suggest.suggest import smallest_cover


@pytest.mark.parametrize("count", [8, 25, 60])
def test_a_normal_band_holds_its_share_as_often_as_it_says(count: int) -> None:
    """The share outside, exactly, over samples of a normal distribution."""
    draw = random.Random(count)
    held = 0
    for _ in range(600):
        sample = [draw.gauss(0.0, 1.0) for _ in range(count)]
        reach = tolerance_factor(count, count - 1) * stdev(sample)
        low, high = fmean(sample) - reach, fmean(sample) + reach
        held += NormalDist().cdf(high) - NormalDist().cdf(low) >= 0.99999
    assert held / 600 > CONFIDENCE - 0.03


@pytest.mark.parametrize("count", [10, 25])
def test_the_range_of_runs_holds_its_share_whatever_they_are(count: int) -> None:
    draw = random.Random(count)
    held = 0
    for _ in range(1000):
        sample = [draw.random() ** 4 for _ in range(count)]
        held += max(sample) ** 0.25 - min(sample) ** 0.25 >= 1 - outside_range(count)
    assert held / 1000 == pytest.approx(CONFIDENCE, abs=0.025)


def test_the_kind_of_a_band_is_that_of_the_runs() -> None:
    draw = random.Random(1)
    normal = [draw.gauss(3.0, 0.1) for _ in range(40)]
    two_places = [draw.choice([0.2, 0.4]) + draw.gauss(0.0, 0.001) for _ in range(40)]
    assert band_of([normal], 0.0)[1].kind == NORMAL
    assert not may_be_normal(two_places)
    assert band_of([two_places], 0.0)[1].kind == FREE
    assert band_of([[5.0] * 9], 0.5)[1].kind == SAME


@pytest.mark.parametrize("values", [[1.0] * 9, [1.0, 1.1, 1.2], [0.1, 0.1, 0.1, 9.0]])
def test_no_band_is_narrower_than_the_tolerance_or_leaves_out_a_run(values: list[float]) -> None:
    (middle,), band = band_of([values], 0.25)
    assert band.tolerance >= 0.25
    assert all(abs(value - middle) <= band.tolerance for value in values)


def test_groups_share_their_spread_but_not_their_middles() -> None:
    draw = random.Random(2)
    groups = [[place + draw.gauss(0.0, 0.01) for _ in range(15)] for place in (1.0, 5.0)]
    middles, band = band_of(groups, 0.0)
    assert middles == pytest.approx([1.0, 5.0], abs=0.02)
    assert band.tolerance < 0.15


@pytest.mark.parametrize("tolerance", [0.00123, 0.5, 1.0, 37.0])
@pytest.mark.parametrize("middle", [-0.000012345, 0.0, 1.23456789, 12345.6789])
def test_what_is_written_is_no_narrower_than_what_was_found(middle: float, tolerance: float) -> None:
    value, within = map(float, rounded(middle, tolerance))
    assert within >= tolerance * 0.999
    assert abs(value - middle) <= 0.06 * tolerance


def test_more_runs_show_more() -> None:
    assert unseen(200) < unseen(20) < unseen(1) < 1.0
    assert outside_range(200) < outside_range(20)


def test_the_cover_is_the_smallest_and_notices_all() -> None:
    draw = random.Random(3)
    for _ in range(30):
        checks = [frozenset(draw.sample(range(8), draw.randint(1, 4))) for _ in range(9)]
        whole = frozenset().union(*checks)
        found = smallest_cover(checks, lambda one: one, lambda one: 0.0)
        assert frozenset().union(*found) == whole
        fewer = combinations(checks, len(found) - 1)
        assert not any(frozenset().union(*some) == whole for some in fewer)
