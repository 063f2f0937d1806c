"""How often does the interval hold the median threshold? Simulations tell.

    python benchmarks/threshold_coverage.py [--campaigns 2000] [--whole]

Prints a table that docs/thresholds.md sums up, with the search that campaigns use, or with whole ladders. A
row is a way in which the thresholds of rounds differ; a column is a number of rounds. Each cell gives the
coverage over all places of the median between two magnitudes, in brackets the lowest of any place, the
median width, upper end / lower end, and the runs per round. The last row is what is promised.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist, median
from typing import Any

import numpy as np

from mutabot.campaign.search import LadderSearch
from mutabot.model.graded import Bracket, MagnitudeResult, bracket_of
from mutabot.results.ladders import median_between

CAMPAIGNS = 2000
ROUNDS = (3, 5, 10, 20)
#: two steps more on each side than medians are spread over, so that few brackets are open
LADDER = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)
#: medians are spread evenly over this decade of the ladder, as logarithms; places are tenths of it
FIRST, PLACES = math.log10(5.0), 10

#: what finds the brackets of rounds whose thresholds are these, and how many runs it takes
Search = Callable[[Sequence[float], int], tuple[list[Bracket], int]]


@dataclass(frozen=True)
class Shape:
    """How the thresholds of rounds are spread, as logarithms.

    Attributes:
        name: in the table.
        draw: differences from the main kind of rounds.
        median: of these differences.
    """

    name: str
    draw: Callable[[np.random.Generator, int], np.ndarray]
    median: float = 0.0


def spread(deviation: float) -> Callable[[np.random.Generator, int], Any]:
    """Log-normal thresholds."""
    return lambda random, rounds: deviation * random.standard_normal(rounds)


def two_kinds(random: np.random.Generator, rounds: int) -> Any:
    """Three rounds of ten are of another kind, with thresholds four times as large."""
    return spread(0.05)(random, rounds) + math.log10(4.0) * (random.random(rounds) < 0.3)


SHAPES = (
    Shape("all alike", spread(0.0005)),
    Shape("sd 0.1 decade", spread(0.1)),
    Shape("one decade (sd 0.25)", spread(0.25)),
    Shape("evenly over a decade", lambda random, rounds: random.random(rounds) - 0.5),
    Shape("two kinds: 30 % of rounds ×4", two_kinds, 0.05 * NormalDist().inv_cdf(0.5 / 0.7)),
)


def look(size: float, threshold: float) -> MagnitudeResult:
    """What the tests make of a magnitude in a round of this threshold."""
    return MagnitudeResult.NOTICED if size >= threshold else MagnitudeResult.MISSED


def whole_ladder(thresholds: Sequence[float], seed: int) -> tuple[list[Bracket], int]:
    """Run every magnitude in every round."""
    found = [bracket_of({size: look(size, at) for size in LADDER}) for at in thresholds]
    return found, len(LADDER) * len(thresholds)


def as_campaigns_do(thresholds: Sequence[float], seed: int) -> tuple[list[Bracket], int]:
    """Run what the search of a campaign asks for: the first round, then all others."""
    search = LadderSearch(len(LADDER), len(thresholds), seed=seed)
    for round, at in enumerate(thresholds):
        while steps := search.due(round):
            for step in steps:
                search.take(round, step, look(LADDER[step], at))
    rows = [search.found[round] for round in range(len(thresholds))]
    found = [bracket_of({LADDER[step]: one for step, one in row.items()}) for row in rows]
    return found, sum(map(len, rows))


def interval(brackets: Sequence[Bracket]) -> tuple[float, float]:
    """The interval of the median threshold."""
    lows = [one.low or 0.0 for one in brackets]
    highs = [math.inf if one.high is None else one.high for one in brackets]
    found = median_between(lows, highs)
    assert found is not None, "there are several rounds"
    return found.low, found.high


def measure(shape: Shape, rounds: int, campaigns: int, search: Search) -> Mapping[str, float]:
    """Coverage, the lowest coverage of any place of the median, the median width, and runs per round."""
    random = np.random.default_rng(7)
    held: list[list[bool]] = [[] for _ in range(PLACES)]
    widths, runs = [], 0
    for number in range(campaigns):
        place = random.random()
        middle = FIRST + place
        thresholds = 10.0 ** (middle - shape.median + shape.draw(random, rounds))
        brackets, count = search(thresholds.tolist(), number)
        low, high = interval(brackets)
        runs += count
        held[int(place * PLACES)].append(low < 10.0**middle <= high)
        widths.append(high / low if low else math.inf)
    every = [one for place in held for one in place]
    worst = min(sum(place) / len(place) for place in held if place)
    per_round = runs / campaigns / rounds
    return {"coverage": sum(every) / len(every), "worst": worst, "width": median(widths), "runs": per_round}


def promised(rounds: int) -> float:
    """The level of the interval."""
    found = median_between([1.0] * rounds, [2.0] * rounds)
    assert found is not None, "there are several rounds"
    return found.level


def cell(shape: Shape, rounds: int, campaigns: int, search: Search) -> str:
    """One cell of the table."""
    found = measure(shape, rounds, campaigns, search)
    text = f"{100 * found['coverage']:.1f} % ({100 * found['worst']:.0f} %), ×{found['width']:.3g}"
    return f"{text}, {found['runs']:.1f} runs"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", type=int, default=CAMPAIGNS)
    parser.add_argument("--whole", action="store_true", help="run every magnitude")
    given = parser.parse_args()
    search = whole_ladder if given.whole else as_campaigns_do
    print(f"| thresholds of rounds | {' | '.join(f'{rounds} rounds' for rounds in ROUNDS)} |")
    print(f"|---|{'---|' * len(ROUNDS)}")
    for shape in SHAPES:
        cells = " | ".join(cell(shape, rounds, given.campaigns, search) for rounds in ROUNDS)
        print(f"| {shape.name} | {cells} |", flush=True)
    print(f"| promised | {' | '.join(f'{100 * promised(rounds):.1f} %' for rounds in ROUNDS)} |")


if __name__ == "__main__":
    main()
