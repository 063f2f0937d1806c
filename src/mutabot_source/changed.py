"""Mutants of files that tests read as text: what is compiled does not show there, so the file is changed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from mutabot.api.faults import Activation, Original, Planned, PlannedMutant, ProgramText

from .refine import planted_of
from .written import TextWriter

ACTIVE = "mutabot_source.inside:ChangedText"
_NOT_WRITTEN = "tests read its file as text, and there is no text that says it there"


def reach_readers(planned: Planned, original: Original, texts: Iterable[ProgramText]) -> None:
    """Note that tests that read the text of a file reach all mutants there."""
    for text in texts:
        for round in range(len(original.tests)):
            tests = original.readers(round, text.file)
            for place in text.places if tests else ():
                planned.reach(round, place.site, tests)


def changing(root: Path, text: ProgramText) -> Iterator[PlannedMutant]:
    """The mutants of a file, each of which really changes it, in processes of its own."""
    content = (root / text.file).read_bytes()
    writer, shared = TextWriter(content), content.decode("latin-1")
    for place in text.places:
        for index, alternative in enumerate(place.alternatives):
            edit = writer.edit(place, alternative)
            if edit is None:
                yield replace(planted_of(place, index, _NOT_WRITTEN), active=None)
                continue
            start, end, written = edit
            data = {"file": text.file, "content": shared, "edit": [start, end, written.decode("latin-1")]}
            active = Activation(ACTIVE, data, (), Activation.AT_ONCE)
            yield replace(planted_of(place, index), active=active)
