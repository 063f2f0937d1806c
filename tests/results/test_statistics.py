"""Intervals, held against simulated campaigns."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import pytest

from mutabot.model import By, Outcome, Verdict
from mutabot.results.score import RoundScores, Score
from mutabot.results.statistics import LEVEL, crossed, sampled, student, wilson

CAMPAIGNS = 1000
#: four standard errors of a coverage of 95 % measured in so many campaigns, in which a sound interval errs
#: once in 16,000 tests; added to the 93 % to 97 % that the interval promises
MARGIN = 4 * math.sqrt(0.95 * 0.05 / CAMPAIGNS)

Draw = Callable[[random.Random], float]


def bimodal(generator: random.Random) -> float:
    """Most mutants are nearly always or nearly never killed."""
    kind = generator.random()
    return 0.998 if kind < 0.6 else 0.005 if kind < 0.8 else generator.uniform(0.02, 0.98)


def uniform(generator: random.Random) -> float:
    return generator.uniform(0.001, 0.999)


def alike(generator: random.Random) -> float:
    return generator.betavariate(8, 2)


def deterministic(generator: random.Random) -> float:
    return 1 - 1e-12 if generator.random() < 0.7 else 1e-12


def shifted(probability: float, shift: float) -> float:
    return 1 / (1 + math.exp(-(math.log(probability / (1 - probability)) + shift)))


def campaign(
    draw: Draw, effect: float, mutants: int, rounds: int, generator: random.Random, missing: float = 0.0
) -> list[list[float | None]]:
    shifts = [generator.gauss(0, effect) for _ in range(rounds)]
    table: list[list[float | None]] = []
    for _ in range(mutants):
        probability = draw(generator)
        row = [float(generator.random() < shifted(probability, shift)) for shift in shifts]
        table.append([None if generator.random() < missing else value for value in row])
    return table


def coverage(draw: Draw, effect: float, mutants: int, rounds: int, missing: float = 0.0) -> float:
    generator = random.Random(7)
    truth = sum(shifted(draw(generator), generator.gauss(0, effect)) for _ in range(100_000)) / 100_000
    held = 0
    for _ in range(CAMPAIGNS):
        found = crossed(campaign(draw, effect, mutants, rounds, generator, missing))
        assert found is not None
        held += found.low <= truth <= found.high
    return held / CAMPAIGNS


@pytest.mark.parametrize(
    ("draw", "effect", "mutants", "rounds", "missing"),
    [
        (bimodal, 0.5, 26, 5, 0.2),
        *(
            pytest.param(*parameters, marks=pytest.mark.whole)
            for parameters in (
                (bimodal, 0.0, 26, 5, 0.0),
                (bimodal, 0.5, 26, 5, 0.0),
                (bimodal, 0.5, 50, 10, 0.0),
                (uniform, 0.5, 26, 5, 0.0),
                (alike, 0.5, 50, 5, 0.0),
                (deterministic, 0.0, 50, 5, 0.0),
            )
        ),
    ],
)
def test_the_interval_of_a_score_covers_what_it_says(
    draw: Draw, effect: float, mutants: int, rounds: int, missing: float
) -> None:
    held = coverage(draw, effect, mutants, rounds, missing)
    assert 0.93 - MARGIN <= held <= 0.97 + MARGIN


def test_cells_of_one_mutant_do_not_count_as_independent() -> None:
    """Five equal rounds tell no more about other mutants than one does."""
    table = [[1.0] * 5] * 14 + [[0.0] * 5] * 6
    found, once = crossed(table), wilson(14, 20)
    assert found is not None
    assert once is not None
    assert found.high - found.low == pytest.approx(once.high - once.low, rel=0.1)


def test_a_round_that_kills_everything_makes_the_interval_wide() -> None:
    calm = crossed([[float((m + r) % 2) for r in range(6)] for m in range(40)])
    stormy = crossed([[float(r % 2) for r in range(6)] for _ in range(40)])
    assert calm is not None
    assert stormy is not None
    assert stormy.high - stormy.low > 3 * (calm.high - calm.low)


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_equal_outcomes_everywhere_are_no_certainty(value: float) -> None:
    found = crossed([[value] * 5] * 26)
    assert found is not None
    assert (found.high == 1.0) == bool(value)
    assert 0.1 < found.high - found.low < 0.3


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_one_odd_outcome_does_not_make_it_certain(value: float) -> None:
    table: list[list[float | None]] = [[value] * 5 for _ in range(26)]
    table[3][2] = 1 - value
    found = crossed(table)
    assert found is not None
    assert found.high - found.low > 0.08


def test_killed_and_survived_mirror_each_other() -> None:
    generator = random.Random(1)
    table = campaign(bimodal, 0.5, 20, 5, generator, missing=0.2)
    found = crossed(table)
    mirrored = crossed([[None if value is None else 1 - value for value in row] for row in table])
    assert found is not None
    assert mirrored is not None
    assert (mirrored.low, mirrored.high) == pytest.approx((1 - found.high, 1 - found.low))


def test_the_order_of_mutants_and_rounds_does_not_matter() -> None:
    table = campaign(uniform, 0.5, 20, 5, random.Random(2), missing=0.2)
    found = crossed(table)
    turned = crossed([row[::-1] for row in table[::-1]])
    assert found is not None
    assert turned is not None
    assert (found.low, found.high) == pytest.approx((turned.low, turned.high))


@pytest.mark.parametrize(
    "table",
    [[], [[1.0, 0.0, 1.0]], [[1.0], [0.0]], [[None, None], [None, None]], [[1.0, None], [0.0, None]]],
)
def test_with_one_mutant_or_one_round_there_is_no_interval(table: list[list[float | None]]) -> None:
    assert crossed(table) is None


@pytest.mark.parametrize(("killed", "valid"), [(killed, 5) for killed in range(6)])
def test_wilson_holds_the_rate_and_stays_a_share(killed: int, valid: int) -> None:
    found = wilson(killed, valid)
    assert found is not None
    assert 0 <= found.low <= killed / valid <= found.high <= 1


def test_wilson_is_the_published_one() -> None:
    """Brown, Cai and DasGupta (2001) invert the score test: at its ends that test is just significant."""
    found = wilson(8, 10)
    assert found is not None
    for end in (found.low, found.high):
        assert abs(0.8 - end) / math.sqrt(end * (1 - end) / 10) == pytest.approx(1.959964, rel=1e-6)
    assert wilson(0, 0) is None


@pytest.mark.parametrize(
    ("freedom", "quantile"),
    [
        (1, 12.706), (2, 4.303), (3, 3.182), (4, 2.776), (5, 2.571), (6, 2.447), (7, 2.365), (8, 2.306),
        (9, 2.262), (10, 2.228), (15, 2.131), (25, 2.060), (60, 2.000), (100, 1.984), (math.inf, 1.960),
    ],
)  # fmt: skip
def test_students_quantile_is_the_published_one(freedom: float, quantile: float) -> None:
    """NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2, column 0.975."""
    assert student(freedom) == pytest.approx(quantile, rel=5e-4)


@pytest.mark.parametrize("freedom", [1, 1.1, 1.3, 1.6, 1.9, 2.2, 2.7, 3.4, 4.5, 7, 10, 15.5, 29, 70, 1000])
def test_half_of_the_level_lies_within_students_quantile(freedom: float) -> None:
    """Simpson's rule on the density: what lies beyond is within what 0.4 % of the quantile make of it."""
    factor = math.exp(math.lgamma((freedom + 1) / 2) - math.lgamma(freedom / 2)) / math.sqrt(
        freedom * math.pi
    )
    steps, end = 2000, student(freedom)
    heights = [
        factor * (1 + (end * n / steps) ** 2 / freedom) ** (-(freedom + 1) / 2) for n in range(steps + 1)
    ]
    weights = [1 if n in (0, steps) else 4 if n % 2 else 2 for n in range(steps + 1)]
    within = (
        end / steps / 3 * math.fsum(weight * height for weight, height in zip(weights, heights, strict=True))
    )
    assert abs(within - LEVEL / 2) <= 0.004 * end * heights[-1]


def test_less_than_one_degree_of_freedom_has_no_quantile() -> None:
    with pytest.raises(ValueError, match="1 or more"):
        student(0.5)


def test_scores_carry_their_intervals() -> None:
    outcomes = [
        Outcome(str(mutant), round, Verdict.KILLED if mutant % 3 else Verdict.SURVIVED, By.CHECK)
        for mutant in range(30)
        for round in range(5)
    ]
    scores = RoundScores.of(outcomes, 5)
    assert scores.interval == scores.check_interval == crossed([[float(bool(m % 3))] * 5 for m in range(30)])
    assert RoundScores.of(outcomes[::5], 1).interval is None


def test_a_kill_rate_has_an_interval_from_two_rounds_on() -> None:
    assert Score({Verdict.KILLED: 3, Verdict.SURVIVED: 2}).interval == wilson(3, 5)
    assert Score({Verdict.KILLED: 1}).interval is None


def sample_coverage(
    size: int, share: float, killed: float, rounds: int, *, noise: float = 0.0, invalid: float = 0.0
) -> float:
    """How often the interval from a sample holds the score of the whole list it was drawn from."""
    generator = random.Random(11)
    held = 0
    for _ in range(CAMPAIGNS):
        rows: list[list[float | None]] = []
        for _ in range(size):
            value, is_valid = generator.random() < killed, generator.random() >= invalid
            flips = [generator.random() < noise for _ in range(rounds)]
            rows.append([float(value ^ flip) if is_valid else None for flip in flips])
        valid = [row for row in rows if row[0] is not None]
        truth = math.fsum(value or 0.0 for row in valid for value in row) / (rounds * len(valid))
        found = sampled(generator.sample(rows, round(size * share)), size)
        held += found is None or found.low - 1e-9 <= truth <= found.high + 1e-9
    return held / CAMPAIGNS


@pytest.mark.parametrize(
    ("size", "share", "killed", "rounds", "noise", "invalid"),
    [
        (100, 0.5, 0.2, 5, 0.05, 0.0),
        *(
            pytest.param(*parameters, marks=pytest.mark.whole)
            for parameters in (
                (40, 0.25, 0.8, 1, 0.0, 0.0),
                (100, 0.1, 0.5, 1, 0.0, 0.0),
                (100, 0.25, 0.95, 1, 0.0, 0.0),
                (100, 0.25, 0.95, 5, 0.05, 0.0),
                (400, 0.1, 0.95, 5, 0.05, 0.0),
                (400, 0.25, 0.5, 5, 0.0, 0.3),
                (400, 0.5, 0.8, 1, 0.0, 0.5),
            )
        ),
    ],
)
def test_the_interval_of_a_sample_covers_what_it_says(
    size: int, share: float, killed: float, rounds: int, noise: float, invalid: float
) -> None:
    assert sample_coverage(size, share, killed, rounds, noise=noise, invalid=invalid) >= 0.94 - MARGIN


def test_a_sample_of_all_mutants_leaves_nothing_open() -> None:
    table = campaign(bimodal, 0.5, 20, 5, random.Random(3), missing=0.2)
    found = sampled(table, 20)
    assert found is not None
    assert found.low == found.high
    outside = crossed(table)
    assert outside is not None
    assert outside.low < found.low < outside.high


def test_the_larger_the_part_of_the_list_the_narrower_the_interval() -> None:
    table = [[1.0]] * 15 + [[0.0]] * 5
    widths = []
    for population in (10_000, 100, 40, 21):
        found = sampled(table, population)
        assert found is not None
        widths.append(found.high - found.low)
    assert widths == sorted(widths, reverse=True)
    assert widths[-1] < 0.25 * widths[0]  # in theory the root of 1/21, 0.22, where Wilson's is symmetric


@pytest.mark.parametrize("table", [[], [[1.0]], [[None], [1.0]]])
def test_with_one_drawn_mutant_nothing_is_said_about_all(table: list[list[float | None]]) -> None:
    assert sampled(table, 50) is None
