"""A plan: mutants to run, and what is left out."""

from __future__ import annotations

from dataclasses import dataclass

from mutabot.journal.records import Drawing
from mutabot.model import LeftOut, Mutant


@dataclass(frozen=True, slots=True)
class Plan:
    """Mutants to run, and what is left out.

    Attributes:
        drawing: how the mutants were drawn from the selected ones; None if all of these are there.
    """

    mutants: list[Mutant]
    left_out: list[LeftOut]
    drawing: Drawing | None = None
