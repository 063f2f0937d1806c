"""What suites with some score caught of real bugs, by the project's benchmark."""

from __future__ import annotations

from collections.abc import Mapping

from mutabot.frozen import frozen

#: fewer valid mutants give a score that says too little
MUTANTS = 10


@frozen
class Caught:
    """Shares of the benchmark's bugs, in per cent, that suites with scores of one band caught.

    Attributes:
        programs: number of programs of the benchmark that have such suites.
        mean: mean over these programs.
        low, high: four suites in five lie between them.
    """

    programs: int
    mean: int
    low: int
    high: int


#: by family, bands of 20 % of the score from 0; ``python benchmarks/real_bugs/coupling.py`` gives the figures
BANDS: Mapping[str, tuple[Caught, ...]] = {
    "robot": (
        Caught(18, 13, 0, 43),
        Caught(18, 36, 14, 78),
        Caught(17, 53, 29, 100),
        Caught(15, 71, 43, 100),
        Caught(11, 87, 60, 100),
    ),
    "bugs": (
        Caught(18, 9, 0, 29),
        Caught(18, 24, 0, 50),
        Caught(18, 46, 20, 71),
        Caught(18, 70, 44, 100),
        Caught(12, 89, 71, 100),
    ),
    "conventional": (
        Caught(16, 9, 0, 33),
        Caught(18, 20, 0, 50),
        Caught(18, 43, 20, 83),
        Caught(17, 70, 43, 100),
        Caught(11, 83, 50, 100),
    ),
}


def bugs_caught(family: str, score: float | None, mutants: int) -> str | None:
    """Return what suites with such a score caught of real bugs, in a sentence.

    Args:
        family: the operators' family.
        score: 0 … 1; None where no mutant is valid.
        mutants: the number of valid mutants.

    Returns:
        None for families that the benchmark does not have, and for fewer than ``MUTANTS`` mutants.
    """
    if score is None or mutants < MUTANTS or family not in BANDS:
        return None
    band = band_of(score)
    caught = BANDS[family][band]
    scores = f"{family} scores of {20 * band} to {20 * band + 20} %"
    return (
        f"In a benchmark of {caught.programs} small programs, four in five suites with {scores} caught "
        f"{caught.low} to {caught.high} % of the real bugs; the mean is {caught.mean} % (docs/real-bugs.md)."
    )


def band_of(score: float) -> int:
    """Return the band, 0 to 4, of a score between 0 and 1; 0.2 is the lower end of band 1."""
    return min(4, int(5 * score))
