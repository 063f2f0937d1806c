"""Mutants of files that tests read as text: the file is changed, as compiled code would not show there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from mutabot.api.faults import Activation, Original, Planned, PlannedMutant, ProgramText

from .refine import planned_mutant
from .written import TextWriter

ACTIVE = "mutabot_source.active:ChangedText"
_NOT_WRITTEN = "tests read its file as text, and there is no text that says it there"


def reach_readers(planned: Planned, original: Original, texts: Iterable[ProgramText]) -> None:
    """Record that tests that read a file's text reach all mutants in it."""
    for text in texts:
        for round in range(len(original.tests)):
            tests = original.readers(round, text.file)
            for place in text.places if tests else ():
                planned.reach(round, place.site, tests)


def changing(root: Path, text: ProgramText) -> Iterator[PlannedMutant]:
    """Yield the mutants of a file, each as a real change of the file for its own processes."""
    content = (root / text.file).read_bytes()
    writer, shared = TextWriter(content), content.decode("latin-1")
    for place in text.places:
        for index, alternative in enumerate(place.alternatives):
            edit = writer.edit(place, alternative)
            if edit is None:
                yield replace(planned_mutant(place, index, _NOT_WRITTEN), active=None)
                continue
            start, end, written = edit
            data = {"file": text.file, "content": shared, "edit": [start, end, written.decode("latin-1")]}
            active = Activation(ACTIVE, data, (), Activation.AT_ONCE)
            yield replace(planned_mutant(place, index), active=active)
