"""How often the interval of ``--budget`` holds the score of all mutants in classes that were begun.

Use: ``python benchmarks/budget_coverage.py [--campaigns 2000] [--seed 1]``. Prints a table in Markdown.
"""

from __future__ import annotations

import argparse
import random

from mutabot.analysis.statistics import stratified


def campaign(
    chance: random.Random, sizes: list[int], scores: list[float], invalid: float
) -> list[list[float | None]]:
    return [
        [None if chance.random() < invalid else float(chance.random() < score) for _ in range(size)]
        for size, score in zip(sizes, scores, strict=True)
    ]


def covers(
    chance: random.Random, classes: list[list[float | None]], parts: list[float]
) -> tuple[bool, float] | None:
    """Whether the interval from a random part of each class holds the score of all; and half its width."""
    cells = [one for those in classes for one in those if one is not None]
    drawn = [
        (chance.sample(those, max(2, round(part * len(those)))), len(those))
        for those, part in zip(classes, parts, strict=True)
    ]
    found = stratified(drawn)
    if found is None or not cells:
        return None
    truth = sum(cells) / len(cells)
    interval = found[1]
    return interval.low - 1e-9 <= truth <= interval.high + 1e-9, (interval.high - interval.low) / 2


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--campaigns", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    settings = {
        "first class whole, 30 % of the next": [1.0, 0.3],
        "60 % of the first class": [0.6],
        "survivors whole, 10 % of the others": [1.0, 0.1],
        "three classes: all, half, 5 %": [1.0, 0.5, 0.05],
    }
    print("| classes | 100 mutants | 400 mutants | 400 mutants, 30 % invalid |")
    print("|---|---|---|---|")
    for name, parts in settings.items():
        cells = []
        for total, invalid in ((100, 0.0), (400, 0.0), (400, 0.3)):
            shares, widths = [], []
            for base in (0.2, 0.5, 0.8, 0.95):
                chance = random.Random(f"{given.seed}:{name}:{total}:{invalid}:{base}")
                size = total // len(parts)
                scores = [
                    min(0.98, max(0.02, base - 0.15 * (len(parts) - 1 - index)))
                    for index in range(len(parts))
                ]
                results = [
                    covers(chance, campaign(chance, [size] * len(parts), scores, invalid), parts)
                    for _ in range(given.campaigns)
                ]
                kept = [one for one in results if one is not None]
                shares.append(sum(held for held, _ in kept) / len(kept))
                widths.append(100 * sum(width for _, width in kept) / len(kept))
            held = f"{100 * min(shares):.1f} to {100 * max(shares):.1f} %"
            cells.append(f"{held} (± {min(widths):.0f} to {max(widths):.0f})")
        print(f"| {name} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
