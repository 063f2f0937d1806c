"""How often does the interval from a sample of mutants hold the score of all of them? Simulations tell.

    python benchmarks/sample_coverage.py [--campaigns 2000]

Prints the table that docs/statistics.md sums up. A row is a number of mutants and the share of them that is
drawn; a column is a kind of campaign. Each cell gives the lowest and the highest coverage over several true
scores, and the range of the intervals' mean half widths. Samples that give no interval, with fewer than two
valid mutants, do not count.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np

from mutabot.results.statistics import sampled

CAMPAIGNS = 2000
SCORES = (0.2, 0.5, 0.8, 0.95)
SIZES = (40, 100, 400)
SHARES = (0.1, 0.25, 0.5)


@dataclass(frozen=True)
class Kind:
    """A kind of campaign.

    Attributes:
        name: in the table.
        rounds: number of rounds.
        noise: how likely a mutant ends otherwise than usual in a round.
        invalid: share of mutants that are never valid.
    """

    name: str
    rounds: int
    noise: float = 0.0
    invalid: float = 0.0


KINDS = (
    Kind("one round", 1),
    Kind("5 rounds, 5 % of outcomes odd", 5, noise=0.05),
    Kind("5 rounds, 30 % of mutants invalid", 5, invalid=0.3),
)


def measure(size: int, share: float, score: float, kind: Kind, campaigns: int) -> tuple[float, float]:
    """Coverage and mean half width."""
    generator = np.random.default_rng(3)
    drawn = round(size * share)
    held, widths = 0, []
    for _ in range(campaigns):
        usual = generator.random((size, 1)) < score
        ends = usual ^ (generator.random((size, kind.rounds)) < kind.noise)
        valid = generator.random(size) >= kind.invalid
        truth = ends[valid].mean()
        rows = [
            ends[index].astype(float).tolist() if valid[index] else [None] * kind.rounds
            for index in generator.choice(size, drawn, replace=False)
        ]
        found = sampled(rows, size)
        if found is not None:
            held += found.low - 1e-9 <= truth <= found.high + 1e-9
            widths.append((found.high - found.low) / 2)
    return held / len(widths), float(np.mean(widths))


def cell(size: int, share: float, kind: Kind, campaigns: int) -> str:
    """One cell of the table."""
    found = [measure(size, share, score, kind, campaigns) for score in SCORES]
    coverage, width = [one[0] for one in found], [one[1] for one in found]
    percents = f"{100 * min(coverage):.1f} to {100 * max(coverage):.1f} %"
    return f"{percents} (± {100 * min(width):.0f} to {100 * max(width):.0f})"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", type=int, default=CAMPAIGNS)
    campaigns = parser.parse_args().campaigns
    print(f"| mutants, drawn | {' | '.join(kind.name for kind in KINDS)} |")
    print(f"|---|{'---|' * len(KINDS)}")
    for size in SIZES:
        for share in SHARES:
            cells = " | ".join(cell(size, share, kind, campaigns) for kind in KINDS)
            print(f"| {size}, {share:.0%} | {cells} |", flush=True)


if __name__ == "__main__":
    main()
