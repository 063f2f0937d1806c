"""The mutants of a program's files, from their text alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from mutabot.api.faults import Site
from mutabot_languages.core.language import Occurrences, occurrences_in
from mutabot_languages.core.text import decode
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.registry import language_for, rewriter_of

from .conventional import ConventionalOperators
from .differences import ProgramFile, TextChange
from .rewriting import Sizes


@dataclass(frozen=True, slots=True)
class PlannedText:
    """A mutant of a file.

    Attributes:
        program: the file, which knows the others of the program.
        site: where it is.
        difference: what it changes.
        description: one line that an engineer recognises.
    """

    program: ProgramFile
    site: Site
    difference: TextChange
    description: str


def read_program(
    root: Path, files: list[str], notify: Callable[[str], None] = lambda text: None
) -> list[ProgramFile]:
    """Read those of these files that are of our languages; what cannot be read is said."""
    found: list[ProgramFile] = []
    for file in files:
        language = language_for(file)
        if language is None:
            continue
        content = (root / file).read_bytes()
        text, encoding = decode(content)
        parsed = language.read(file, text)
        for diagnostic in parsed.diagnostics:
            notify(diagnostic.text)
        found.append(ProgramFile(file, language, content, encoding, text, parsed))
    for program in found:
        alike = (other for other in found if other.language is program.language)
        program.others.extend(other for other in alike if other is not program)
    return found


def mutants_of(program: ProgramFile, sizes: Sizes | None = None) -> Iterator[PlannedText]:
    """Yield the mutants of a file, in the order of its text."""
    occurrences = occurrences_in(program.parsed.tree, program.text)
    rewriter = rewriter_of(program.language)(program, sizes)
    made = [*rewriter.differences(), *ConventionalOperators(rewriter).differences()]
    made.sort(key=lambda change: (change.node.start, change.node.end))
    seen: set[tuple[str, tuple[object, ...]]] = set()
    for change in made:
        key = (change.operator, change.edits)
        if key in seen or not program.is_sound(change):
            continue
        seen.add(key)
        site = _site(program, change.node, occurrences)
        note = f" ({change.note})" if change.note else ""
        yield PlannedText(program, site, change, f"{program.shown(change)}{note}")


def planned_texts(root: Path, files: list[str]) -> Iterator[PlannedText]:
    """Yield all mutants of a program's files."""
    for program in read_program(root, files):
        yield from mutants_of(program)


def _site(program: ProgramFile, node: ProgramNode, occurrences: Occurrences) -> Site:
    routine, text, number = occurrences[node.start, node.end]
    extent = program.parsed.source.extent(node.start, node.end)
    return Site.in_program(program.file, extent, routine, text, number)
