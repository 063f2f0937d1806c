"""The program text of a campaign: its places, what the baseline saw there, and what turns a mutant on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from mutabot.campaign.workers.task import Result
from mutabot.families import CONTROL, OF_TEXT, ROBOT
from mutabot.model import (
    FATAL,
    IDENTITY,
    Alternative,
    Choice,
    Instrumentation,
    LeftOut,
    Mutant,
    ProgramText,
    TextPlace,
)
from mutabot.operators import load_all
from mutabot.operators.control import Identity
from mutabot_source import Planted, find_texts, merge, names, plant, program_files, refine
from mutabot_source.mutants import LeftOutText

from .places import Place


def family_of(mutant: str) -> str:
    """The family of the mutant with this id; that of calls where nobody knows its operator any more."""
    operator = mutant.rpartition(":")[2].partition("=")[0]
    return _families().get(operator, ROBOT)


@cache
def _families() -> dict[str, str]:
    """The family of each operator, by name."""
    of_calls = {rule.name: rule.family for rule in load_all()}
    return of_calls | {name: family for family in OF_TEXT for name in names(family)}


def read_texts(
    root: Path, program: Iterable[str], families: Iterable[str]
) -> tuple[tuple[ProgramText, ...], dict[str, str]]:
    """All places of the program that these families have to do with; files that cannot be read, and why."""
    wanted = _operators_of(families)
    texts: list[ProgramText] = []
    refused: dict[str, str] = {}
    if not wanted:
        return (), refused
    first = 1
    for file in program_files(root, program):
        try:
            (text,) = find_texts(root, [file], wanted, first=first)
        except Exception as error:  # two parsers look at it, and each says in its own way what it cannot read
            refused[file] = f"it cannot be read: {str(error).splitlines()[0]}"
            continue
        first += len(text.places)
        texts.append(text)
    return tuple(texts), refused


def _operators_of(families: Iterable[str]) -> list[str]:
    wanted = set(families)
    return [name for family in OF_TEXT if family in wanted for name in names(family)]


@dataclass(slots=True)
class ProgramTexts:
    """The program text after the baseline.

    Attributes:
        texts: the files with the alternatives that can run.
        left_out: alternatives that cannot, or cannot matter.
        planted: mutants of the first order by id, numbered from 1.
        reached: (round, place) to the tests in which it was reached; ``""`` stands for before any test.
        early: places that are evaluated before any test or while a module is imported: what stands there
            holds for a whole process.
    """

    texts: tuple[ProgramText, ...] = ()
    left_out: list[LeftOut] = field(default_factory=list)
    planted: dict[str, Planted] = field(default_factory=dict)
    reached: dict[tuple[int, Place], list[str]] = field(default_factory=dict)
    early: set[Place] = field(default_factory=set)
    _numbers: dict[Place, int] = field(default_factory=dict)

    @classmethod
    def of(
        cls, texts: Iterable[ProgramText], results: Mapping[int, Result], families: Iterable[str]
    ) -> ProgramTexts:
        """What recordings of the baseline, by round, tell about these texts, read for these families."""
        texts = list(texts)
        why = _not_instrumented(texts, results.values())
        sightings = [
            seen for _, result in sorted(results.items()) if result.seen for seen in result.seen.sightings
        ]
        instrumented = [text for text in texts if text.file not in why]
        refined, left_out = refine(instrumented, merge(sightings), _operators_of(families))
        unread = [
            LeftOutText(*one, why[text.file]) for text in texts if text.file in why for one in _all(text)
        ]
        planted = sorted(plant(refined), key=lambda one: OF_TEXT.index(one.mutant.family))
        made = cls(refined, [one.as_left_out for one in [*left_out, *unread]])
        for number, one in enumerate(planted, start=1):
            made.planted[one.mutant.id] = replace(one, mutant=replace(one.mutant, number=number))
            made._numbers.setdefault(Place.of(one.mutant), one.choice.place)
        for round, result in sorted(results.items()):
            made._note_reached(round, result)
        return made

    def choices(self, mutant: Mutant) -> tuple[Choice, ...]:
        """The alternatives that a mutant is; none for one that acts on calls only."""
        return tuple(self._choice(single) for single in mutant.singles if not single.operation)

    def is_early(self, mutant: Mutant) -> bool:
        """Whether a mutant needs a process of its own."""
        return any(Place.of(single) in self.early for single in mutant.singles)

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

    def _choice(self, mutant: Mutant) -> Choice:
        if mutant.family == CONTROL:
            index = IDENTITY if mutant.operator == Identity.name else FATAL
            return Choice(self._numbers[Place.of(mutant)], index)
        return self.planted[mutant.id].choice

    def _note_reached(self, round: int, result: Result) -> None:
        places = {place.number: place for text in self.texts for place in text.places}
        told = [(result.reached, True), (result.reached_elsewhere, False)]
        for test, numbers, is_here in ((*one, is_here) for found, is_here in told for one in found.items()):
            for place in (places[number] for number in numbers if number in places):
                where = Place(place.site, "")
                tests = self.reached.setdefault((round, where), [])
                if test not in tests:
                    tests.append(test)
                # what a process below the tests evaluates holds for that process alone
                if (place.at_import and is_here) or not test:
                    self.early.add(where)


def _not_instrumented(texts: Iterable[ProgramText], results: Iterable[Result]) -> dict[str, str]:
    """Files whose alternatives cannot run, with the reason."""
    results = list(results)
    imported = {file for result in results if result.seen for file in result.seen.imported}
    refused = {file: why for result in results for file, why in result.not_instrumented.items()}
    never = {text.file: "no test imports it" for text in texts if text.file not in imported}
    return {**never, **refused}


def _all(text: ProgramText) -> list[tuple[TextPlace, Alternative]]:
    return [(place, alternative) for place in text.places for alternative in place.alternatives]
