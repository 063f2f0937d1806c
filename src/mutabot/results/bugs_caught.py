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
        Caught(12, 14, 0, 43),
        Caught(12, 33, 14, 67),
        Caught(12, 53, 29, 86),
        Caught(11, 72, 43, 100),
        Caught(8, 90, 71, 100),
    ),
    "bugs": (
        Caught(12, 10, 0, 29),
        Caught(12, 24, 0, 50),
        Caught(12, 47, 17, 71),
        Caught(12, 71, 43, 100),
        Caught(9, 88, 71, 100),
    ),
    "conventional": (
        Caught(12, 11, 0, 33),
        Caught(12, 24, 0, 50),
        Caught(12, 50, 29, 83),
        Caught(11, 77, 57, 100),
        Caught(6, 89, 71, 100),
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
