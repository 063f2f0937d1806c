"""Ladders of a plan: the mutants that are one graded fault at rising magnitudes."""

from __future__ import annotations

from collections.abc import Iterable

from mutabot.frozen import frozen
from mutabot.model import Mutant


@frozen
class Ladder:
    """One graded fault at one site, of one quantity, in one direction.

    Attributes:
        id: what its mutants' ids have in common.
        mutants: by rising magnitude.
    """

    id: str
    mutants: tuple[Mutant, ...]


def apart(mutants: Iterable[Mutant]) -> tuple[list[Mutant], list[Ladder]]:
    """The mutants that stand alone, and the ladders."""
    alone: list[Mutant] = []
    found: dict[str, list[Mutant]] = {}
    for mutant in mutants:
        if mutant.ladder:
            found.setdefault(mutant.ladder, []).append(mutant)
        else:
            alone.append(mutant)
    ladders = [
        Ladder(name, tuple(sorted(those, key=lambda one: one.magnitude or 0.0)))
        for name, those in found.items()
    ]
    return alone, ladders
