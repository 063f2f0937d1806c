"""Mutants of files that tests read as text: the file is changed too, as compiled code does not show there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from mutabot.api.faults import Original, Planned, PlannedMutant, ProgramText

from .refine import planned_mutant
from .written import TextWriter

_NOT_WRITTEN = "tests read its file as text, and there is no text that says it there"


def reach_readers(planned: Planned, original: Original, texts: Iterable[ProgramText]) -> None:
    """Record that tests that read a file's text reach all mutants in it."""
    for text in texts:
        for round in range(len(original.tests)):
            tests = original.readers(round, text.file)
            for place in text.places if tests else ():
                planned.reach(round, place.site, tests)


def changing(root: Path, text: ProgramText, original: Original) -> Iterator[PlannedMutant]:
    """Yield the mutants of a file, each with the text that the file has in its processes."""
    content = (root / text.file).read_bytes()
    writer, shared = TextWriter(content), content.decode("latin-1")
    tests = _tests_before_readers(original, text.file)
    for place in text.places:
        for index, alternative in enumerate(place.alternatives):
            edit = writer.edit(place, alternative)
            if edit is None:
                yield replace(planned_mutant(place, index, _NOT_WRITTEN), active=None)
                continue
            start, end, written = edit
            planned = planned_mutant(place, index)
            assert planned.active is not None
            changed = start, end, written.decode("latin-1")
            yield replace(planned, active=planned.active.with_file(text.file, shared, changed, tests))


def _tests_before_readers(original: Original, file: str) -> list[str] | None:
    """Return, of each round in which a file is read, the test before the first that reads it.

    None if it may be read before any test: what is read while tests are collected counts for the first.
    """
    found: list[str] = []
    for round, tests in enumerate(original.tests):
        readers = original.readers(round, file)
        if not readers:
            continue
        if readers[0] not in tests[1:]:
            return None
        # hooks of the suite may read it after that test
        found.append(tests[tests.index(readers[0]) - 1])
    return found
