"""The provider of faults in the program text.

What looks at program text is imported only when there is some to look at: a campaign that asks for none of
these mutants does not wait for it.
"""

# ruff: noqa: PLC0415  # see above

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from mutabot.faults import FaultProvider, Planned, Preparation, Project
from mutabot.languages.registry import program_files
from mutabot.model.mutant import Place, ProgramText
from mutabot.original import Original, TextSeen

from .extension import OF_TEXT, PROVIDER

if TYPE_CHECKING:
    from .operator import ConventionalOperator


class SourceFaults(FaultProvider):
    """Conventional operators, and faults in the characters of command strings."""

    name = PROVIDER
    families = OF_TEXT
    location = "program text"

    def rules(self) -> Sequence[ConventionalOperator]:
        """All operators on program text."""
        from .registry import load_all

        return load_all()

    def prepare(self, project: Project, first: int) -> Preparation:
        """The places of the program that the families asked for have to do with."""
        from .texts import find_texts

        wanted = self._operators(project)
        texts: list[ProgramText] = []
        notes: list[str] = []
        for file in program_files(project.root, project.program):
            try:
                (text,) = find_texts(project.root, [file], wanted, first=first)
            except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
                notes.append(
                    f"no mutants of the text of {file}: it cannot be read: {str(error).splitlines()[0]}"
                )
                continue
            first += len(text.places)
            texts.append(text)
        return Preparation(tuple(texts), tuple(notes))

    def plan(self, project: Project, prepared: Preparation, original: Original) -> Planned:
        """The alternatives that can run and fit the types that were seen."""
        if not prepared.texts:
            return Planned()
        from .refine import merge, plant, planted_of, refine

        seen = [seen for _, seen in sorted(original.text.items())]
        why = {file: why for one in seen for file, why in one.refused.items()}
        texts, left_out = refine(
            (text for text in prepared.texts if text.file not in why),
            merge(one for found in seen for one in found.sightings),
            self._operators(project),
            _reached(seen),
        )
        left_out += [
            planted_of(place, index, why[text.file])
            for text in prepared.texts
            if text.file in why
            for place in text.places
            for index in range(len(place.alternatives))
        ]
        mutants = [replace(one, order=(OF_TEXT.index(one.mutant.family),)) for one in plant(texts)]
        planned = Planned([*mutants, *left_out], texts)
        for round, found in sorted(original.text.items()):
            _note_reached(planned, round, found)
        return planned

    def _operators(self, project: Project) -> list[str]:
        from .registry import names

        return [name for family in OF_TEXT if family in project.families for name in names(family)]


def _note_reached(planned: Planned, round: int, seen: TextSeen) -> None:
    places = {place.number: place for text in planned.texts for place in text.places}
    for origin, found in (("", seen.reached), *seen.below.items()):
        reaching: dict[int, list[str]] = {}  # the tests by place: a suite may have ten thousand
        for test, numbers in found.items():
            for number in numbers:
                reaching.setdefault(number, []).append(test)
        for number, tests in reaching.items():
            place = places.get(number)
            if place is None:
                continue
            where = Place(place.site, "")
            known = planned.reached.setdefault((round, where), [])
            there = set(known)
            known += [test for test in tests if test not in there]
            for test in tests if origin else ():
                planned.below.setdefault((round, where, test), set()).add(origin)
            # what a process below the tests evaluates holds for that process alone
            if (place.at_import and not origin) or "" in tests:
                planned.early.add(where)


def _reached(seen: Sequence[TextSeen]) -> set[int]:
    """The numbers of the places that any test reached, itself or in processes below it."""
    found = (tests for one in seen for tests in (one.reached, *one.below.values()))
    return {number for tests in found for numbers in tests.values() for number in numbers}
