"""The provider of faults in the program text.

What looks at program text is imported only when there is some to look at: a campaign that asks for none of
these mutants does not wait for it.
"""

# ruff: noqa: PLC0415  # see above

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from mutabot.api.faults import FaultProvider, Original, Planned, ProgramText, Project

from .extension import OF_TEXT, PROVIDER

if TYPE_CHECKING:
    from .operator import ConventionalOperator


_NO_MUTANTS = "no mutants of the text of {}"
_NO_PYTHON = "it is not Python, the only language that has operators on its text"


class SourceFaults(FaultProvider):
    """Provides the conventional operators, and faults in the characters of command strings."""

    name = PROVIDER
    families = OF_TEXT
    location = "program text"
    in_program = True

    def rules(self) -> Sequence[ConventionalOperator]:
        """Return all operators on program text."""
        from .registry import load_all

        return load_all()

    def texts(self, project: Project, first: int, notify: Callable[[str], None]) -> Sequence[ProgramText]:
        """Return the program text with the places that the requested families change."""
        from .texts import find_texts

        wanted = self._operators(project)
        texts: list[ProgramText] = []
        for file in project.program_files():
            if not project.is_python(file):
                notify(f"{_NO_MUTANTS.format(file)}: {_NO_PYTHON}")
                continue
            try:
                (text,) = find_texts(project.root, [file], wanted, first=first)
            except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
                notify(f"{_NO_MUTANTS.format(file)}: it cannot be read: {str(error).splitlines()[0]}")
                continue
            first += len(text.places)
            texts.append(text)
        return texts

    def plan(self, project: Project, original: Original) -> Planned:
        """Return the mutants of the alternatives that can run and fit the observed types."""
        looked_at = original.texts.get(self.name, ())
        if not looked_at:
            return Planned()
        from .changed import changing, reach_readers
        from .refine import plan_mutants, planned_mutant, refine

        why = original.refused_files()
        readable = [text for text in looked_at if text.file not in why]
        texts, left_out = refine(readable, original, self._operators(project))
        left_out += [
            planned_mutant(place, index, why[text.file])
            for text in looked_at
            if text.file in why
            for place in text.places
            for index in range(len(place.alternatives))
        ]
        found = (
            changing(project.root, text, original) if original.is_read(text.file) else plan_mutants([text])
            for text in texts
        )
        mutants = [
            replace(planned_fault, order=(OF_TEXT.index(planned_fault.mutant.family),))
            for each in found
            for planned_fault in each
        ]
        planned = Planned([*mutants, *left_out], texts)
        reach_readers(planned, original, texts)
        return planned

    def _operators(self, project: Project) -> list[str]:
        from .registry import names

        return [name for family in OF_TEXT if family in project.families for name in names(family)]
