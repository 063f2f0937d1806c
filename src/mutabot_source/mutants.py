"""From alternatives to mutants, with the ids that the journal and the reports use."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from mutabot.model import LeftOut, Mutant
from mutabot.model.alternative import Alternative, Choice, ProgramText, TextPlace

from .rendering import shortened


@dataclass(frozen=True, slots=True)
class Planted:
    """A mutant of the program text, and the choice that turns it on."""

    mutant: Mutant
    choice: Choice
    place: TextPlace


@dataclass(frozen=True, slots=True)
class LeftOutText:
    """An alternative that is not used, with the reason."""

    place: TextPlace
    alternative: Alternative
    reason: str

    @property
    def as_left_out(self) -> LeftOut:
        """The same as the plan lists it."""
        mutant = mutant_of(0, self.place, self.alternative)
        return LeftOut(mutant.id, mutant.description, self.reason)


def plant(texts: Iterable[ProgramText], *, first: int = 1) -> list[Planted]:
    """All mutants of these texts, numbered from ``first``, in the order of the text."""
    planted: list[Planted] = []
    for text in texts:
        for place in text.places:
            for index, alternative in enumerate(place.alternatives):
                mutant = mutant_of(first + len(planted), place, alternative)
                planted.append(Planted(mutant, Choice(place.number, index), place))
    return planted


def mutant_of(number: int, place: TextPlace, alternative: Alternative) -> Mutant:
    """The mutant that an alternative is."""
    return Mutant(
        number=number,
        family=alternative.family,
        operator=alternative.operator,
        site=place.site,
        operation="",
        pattern=None,
        quantity=None,
        variant=alternative.variant,
        description=f"{place.text} → {shortened(alternative.text)}",
    )
