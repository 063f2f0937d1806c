"""Estimates of false kills and false survivors, against enumeration and simulation."""

from __future__ import annotations

import random
from math import comb

import pytest

from mutabot.journal.records import Repeated, Repeats
from mutabot.results.statistics import confirmed_by_chance, false_kills, false_survivors, remaining

TAIL = 0.025


def probability(seen: int, total: int, changed: int, drawn: int) -> float:
    return comb(changed, seen) * comb(total - changed, drawn - seen) / comb(total, drawn)


@pytest.mark.parametrize(("total", "drawn", "seen"), [(20, 5, 0), (20, 5, 2), (12, 11, 3), (30, 10, 10)])
def test_the_interval_holds_the_numbers_that_the_sample_does_not_speak_against(
    total: int, drawn: int, seen: int
) -> None:
    possible = [
        changed - seen
        for changed in range(seen, total - drawn + seen + 1)
        if sum(probability(k, total, changed, drawn) for k in range(seen + 1)) > TAIL
        and sum(probability(k, total, changed, drawn) for k in range(seen, min(drawn, changed) + 1)) > TAIL
    ]
    assert remaining(Repeated(total, drawn, seen)) == (min(possible), max(possible))


def test_nothing_remains_where_all_were_repeated() -> None:
    assert remaining(Repeated(20, 20, 3)) == (0, 0)


@pytest.mark.parametrize(("chance", "mutants"), [(0.03, 60), (0.1, 60), (0.1, 15)])
def test_false_kills_that_come_out_twice_are_within_the_interval(chance: float, mutants: int) -> None:
    rng = random.Random(4)
    held, campaigns, true_kills = 0, 1000, 20
    for _ in range(campaigns):
        false = sum(rng.random() < chance for _ in range(mutants))
        twice = sum(rng.random() < chance for _ in range(false))
        repeats = Repeats(
            Repeated(true_kills + false, true_kills + false, false - twice),
            survivors=Repeated(mutants - false),
        )
        estimate = false_kills(repeats)
        assert estimate is not None
        held += estimate.low <= twice <= estimate.high
    assert held / campaigns >= 0.95


def test_kinds_of_kills_are_summed_and_those_never_repeated_are_unknown() -> None:
    estimate = false_kills(Repeats(Repeated(4, 2, 1), Repeated(30), certain=9, survivors=Repeated(20)))
    assert estimate is not None
    assert estimate.expected == pytest.approx(1.0 + 1 / 21)
    assert (estimate.known, estimate.unknown) == (3, 30)
    assert false_kills(Repeats(Repeated(4), Repeated(30))) is None
    assert false_survivors(Repeats(survivors=Repeated(20))) is None


def test_large_campaigns_are_no_trouble() -> None:
    low, high = remaining(Repeated(100_000, 100, 5))
    assert 1_500 < low < 5_000 < high < 12_000
    assert confirmed_by_chance(500, 10_000, 5_000)[0] == pytest.approx(500 * 500 / 5_500)
    assert confirmed_by_chance(0, 50, 20) == (0.0, 0)
