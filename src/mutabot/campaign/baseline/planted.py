"""The mutants of a plan with what is known of them in the controller alone, and what makes them active."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from mutabot.border.job import InProcess
from mutabot.families import CALLS, CONTROL, MESSAGES
from mutabot.faults import Planned, Planted
from mutabot.model import FATAL, IDENTITY, Choice, Instrumentation, Mutant, ProgramText
from mutabot.model.mutant import Place
from mutabot.operators.command import Identity

#: what a control is at a place of a fault that is put in place by its provider's own code
_CONTROLS = "mutabot.inside.process_fault"


@dataclass(slots=True)
class PlantedFaults:
    """What the providers have planted.

    Attributes:
        by_id: the mutants of the first order.
        left_out_beforehand: those left out for another reason than that they would change nothing in the
            calls of the baseline.
        texts: program text with the alternatives that can run.
        providers: who told of a place, for all places but those of calls.
    """

    by_id: dict[str, Planted] = field(default_factory=dict)
    left_out_beforehand: list[Planted] = field(default_factory=list)
    texts: tuple[ProgramText, ...] = ()
    providers: dict[Place, str] = field(default_factory=dict)
    _numbers: dict[Place, int] = field(default_factory=dict)

    @classmethod
    def of(cls, planned: Mapping[str, Planned]) -> PlantedFaults:
        """Of what each provider made of a baseline."""
        made = cls()
        for provider, found in planned.items():
            made.texts += found.texts
            made.providers.update((place, provider) for _, place in found.reached)
            for one in found.mutants:
                if one.reason is None:
                    made.by_id[one.mutant.id] = one
                    if one.choice is not None:
                        made._numbers.setdefault(Place.of(one.mutant), one.choice.place)
                elif provider not in (CALLS, MESSAGES):
                    made.left_out_beforehand.append(one)
        return made

    def provider_at(self, place: Place) -> str:
        """The provider whose way into the program mutants at a place take."""
        return self.providers.get(place, CALLS)

    def choices(self, mutant: Mutant) -> tuple[Choice, ...]:
        """The alternatives in the program text that a mutant is."""
        choice = self._choice(mutant)
        return () if choice is None else (choice,)

    def in_process(self, mutant: Mutant) -> dict[str, InProcess]:
        """What puts a mutant in place that its provider does by itself, by the mutant's id."""
        how = self._in_process(mutant)
        return {} if how is None else {mutant.id: how}

    def instrumentation(self, mutants: Iterable[Mutant], *, active: bool = False) -> Instrumentation | None:
        """The program text with the places of these mutants, or None if they have none there.

        Args:
            mutants: the mutants.
            active: whether their alternatives are in force from the start.
        """
        choices = [choice for mutant in mutants for choice in self.choices(mutant)]
        if not choices:
            return None
        needed = {choice.place for choice in choices}
        texts = [
            replace(text, places=tuple(place for place in text.places if place.number in needed))
            for text in self.texts
        ]
        return Instrumentation(
            tuple(text for text in texts if text.places), active=tuple(choices) if active else ()
        )

    def _choice(self, mutant: Mutant) -> Choice | None:
        if mutant.family == CONTROL:
            number = self._numbers.get(Place.of(mutant))
            index = IDENTITY if mutant.operator == Identity.name else FATAL
            return Choice(number, index) if number is not None else None
        planted = self.by_id.get(mutant.id)
        return planted.choice if planted is not None else None

    def _in_process(self, mutant: Mutant) -> InProcess | None:
        if mutant.family == CONTROL:
            place = Place.of(mutant)
            is_own = place in self.providers and place not in self._numbers
            return InProcess(f"{_CONTROLS}:{mutant.operator.capitalize()}") if is_own else None
        planted = self.by_id.get(mutant.id)
        return planted.in_process if planted is not None else None
