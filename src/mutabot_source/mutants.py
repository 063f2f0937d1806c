"""From alternatives to mutants, with the ids that the journal and the reports use."""

from __future__ import annotations

from collections.abc import Iterable

from mutabot.border.codec import to_data
from mutabot.faults import Planted
from mutabot.model import Mutant
from mutabot.model.alternative import Alternative, Choice, ProgramText, TextPlace

from .families import PROVIDER
from .rendering import shortened


def plant(texts: Iterable[ProgramText]) -> list[Planted]:
    """All mutants of these texts, in the order of the text."""
    return [
        planted_of(place, index)
        for text in texts
        for place in text.places
        for index in range(len(place.alternatives))
    ]


def planted_of(place: TextPlace, index: int, reason: str | None = None) -> Planted:
    """The mutant that an alternative at a place is, or would be were it not left out for a reason."""
    alternative = place.alternatives[index]
    return Planted(
        _mutant_of(place, alternative),
        reason,
        does=to_data(alternative),
        mentions=alternative.template,
        choice=Choice(place.number, index),
    )


def _mutant_of(place: TextPlace, alternative: Alternative) -> Mutant:
    return Mutant(
        number=0,
        family=alternative.family,
        operator=alternative.operator,
        site=place.site,
        operation="",
        pattern=None,
        quantity=None,
        variant=alternative.variant,
        description=f"{place.text} → {shortened(alternative.text)}",
        provider=PROVIDER,
    )
