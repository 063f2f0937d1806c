"""Journals of graded campaigns, written from a few letters per round."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path as File
from typing import Any

from mutabot.families import GRADED
from mutabot.journal.journal import Journal
from mutabot.model import By, Mutant, Outcome, Verdict, Vocabulary
from mutabot.model.codec import to_data
from mutabot.model.mutant import Site
from mutabot.results.results import Results, read_results
from mutabot.thresholds.ladders import Ladder, ladders_of
from results import samples

SIZES = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
#: what a letter stands for; a blank or a dot is a magnitude that was not run
LETTERS: Mapping[str, tuple[Verdict, By | None]] = {
    "C": (Verdict.KILLED, By.CHECK),
    "X": (Verdict.KILLED, By.EXCEPTION),
    "T": (Verdict.TIMEOUT, None),
    "S": (Verdict.SURVIVED, None),
    "R": (Verdict.REFUSED, None),
    "N": (Verdict.NO_EFFECT, None),
    "U": (Verdict.UNSTABLE, None),
    "E": (Verdict.ERROR, None),
    "-": (Verdict.NOT_COVERED, None),
}


@dataclass(frozen=True)
class Rungs:
    """One ladder.

    Attributes:
        rounds: per round a letter for each magnitude, rising.
    """

    rounds: Sequence[str]
    direction: str = "+"
    site: Site = samples.MOVE
    quantity: str = "dx"
    operator: str = "offset"
    unit: str | None = "mm"
    sizes: Sequence[float] = SIZES
    operation: str = "robot:Arm.move_by"

    def mutant(self, number: int, size: float) -> Mutant:
        variant = f"{self.direction}{size:g}{self.unit or ''}"
        return Mutant(
            number, GRADED, self.operator, self.site, self.operation, None, self.quantity, variant,
            f"{self.site.text}: {self.quantity} {variant}", magnitude=size, unit=self.unit,
            direction=self.direction, has_sizes=True,
        )  # fmt: skip


def write(path: File, *ladders: Rungs, vocabulary: Vocabulary = samples.VOCABULARY, **changes: Any) -> File:
    """The journal of a campaign with these ladders, after the mutants of the samples if ``with_others``."""
    others = changes.pop("with_others", False)
    mutants: list[Mutant] = list(samples.MUTANTS) if others else []
    outcomes: list[Outcome] = list(samples.OUTCOMES) if others else []
    for written_ladder in ladders:
        for column, size in enumerate(written_ladder.sizes):
            mutant = written_ladder.mutant(len(mutants) + 1, size)
            mutants.append(mutant)
            for number, letters in enumerate(written_ladder.rounds):
                letter = letters[column]
                if letter in LETTERS:
                    verdict, by = LETTERS[letter]
                    outcomes.append(Outcome(mutant.id, number, verdict, by, tests=1, test=samples.TEST))
    facts = {
        "families": [GRADED],
        "rounds": max((len(any_ladder.rounds) for any_ladder in ladders), default=2),
        "vocabulary": to_data(vocabulary),
        **changes,
    }
    return samples.write_journal(path, mutants=tuple(mutants), outcomes=tuple(outcomes), **facts)


def results(folder: File, *ladders: Rungs, **changes: Any) -> Results:
    """What the journal of such a campaign holds."""
    with Journal.open(write(folder / "journal.sqlite", *ladders, **changes)) as journal:
        return read_results(journal)


def ladder(folder: File, *rounds: str, **more: Any) -> Ladder:
    """The only ladder of such a campaign."""
    (found,) = ladders_of(results(folder, Rungs(rounds, **more)))
    return found
