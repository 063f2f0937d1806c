"""A difference that a mutant makes to a program's text, and the check that the text is still a program."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from dataclasses import dataclass, field

from mutabot_languages.core.language import RobotLanguage
from mutabot_languages.core.parser import ParsedFile
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.edits import Edit, applied

#: what stands where a statement is missing
MISSING = ("", ";", "pass")
_UNOBSERVABLE = {
    "change-blend": "corners are not rounded here, so that it cannot be observed",
    "wrong-configuration": "the arm takes the nearest configuration here, so that it cannot be observed",
}


@dataclass(frozen=True, slots=True)
class TextChange:
    """What a mutant changes in one file.

    Attributes:
        operator: the name of its operator.
        node: what it is about: the mutant's site.
        edits: what becomes of the text.
        variant: which of several of the operator here; with sizes, the direction alone.
        magnitude, unit: of a fault with sizes.
        note: what an engineer should know of the changed program.
    """

    operator: str
    node: ProgramNode
    edits: tuple[Edit, ...]
    variant: str = ""
    magnitude: float | None = None
    unit: str | None = None
    note: str = ""

    @property
    def reason(self) -> str | None:
        """Why it is left out; None if it is planted."""
        return _UNOBSERVABLE.get(self.operator)


@dataclass(frozen=True, slots=True)
class ProgramFile:
    """A file that mutants are made of.

    Attributes:
        file: path relative to the project's root.
        language: what it is written in.
        content: its bytes.
        encoding: of them.
        text: its text.
        parsed: what stands in it.
        others: the other files of the program, which may declare what it names.
    """

    file: str
    language: RobotLanguage
    content: bytes
    encoding: str
    text: str
    parsed: ParsedFile
    others: list[ProgramFile] = field(default_factory=list)
    _mistakes: dict[tuple[int, int], int] = field(default_factory=dict)

    def shown(self, difference: TextChange) -> str:
        """Return how the difference reads: ``Offs(p,0,0,100) → Offs(p,0,0,-100)``, the statement in short."""
        before, after = self._statement(difference)
        first, node = difference.edits[0], difference.node
        if first.text in MISSING and (first.start, first.end) == (node.start, node.end):
            return f"{before} deleted"
        before, after = _shorter(before, after)
        return f"{before} → {after}"

    def _statement(self, difference: TextChange) -> tuple[str, str]:
        starts = [difference.node.start, *(edit.start for edit in difference.edits)]
        ends = [difference.node.end, *(edit.end for edit in difference.edits)]
        before, after = self._part(min(starts), max(ends), difference)
        return " ".join(before.split()), " ".join(after.split())

    def _part(self, start: int, end: int, difference: TextChange) -> tuple[str, str]:
        """Return a part of the text, as it is and as a mutant."""
        inside = [Edit(edit.start - start, edit.end - start, edit.text) for edit in difference.edits]
        return self.text[start:end], applied(self.text[start:end], inside)

    def changed(self, difference: TextChange) -> str:
        """Return the text of the file as a mutant."""
        return applied(self.text, difference.edits)

    def diff(self, difference: TextChange) -> list[str]:
        """Return the lines of a unified diff without context, without line feeds, else as in the file."""
        old, new = (text.split("\n") for text in (self.text, self.changed(difference)))
        return [*difflib.unified_diff(old, new, f"a/{self.file}", f"b/{self.file}", n=0, lineterm="")]

    def is_sound(self, difference: TextChange) -> bool:
        """Return whether the changed text differs and still reads as well as the original does."""
        start, end = self._around(difference)
        before, after = self._part(start, end, difference)
        if (start, end) not in self._mistakes:
            self._mistakes[start, end] = len(self.language.read("", before).diagnostics)
        is_changed = before != after
        return is_changed and len(self.language.read("", after).diagnostics) <= self._mistakes[start, end]

    def _around(self, difference: TextChange) -> tuple[int, int]:
        """Return the smallest routine, or statement of the file, that holds all edits."""
        first = min(edit.start for edit in difference.edits)
        last = max(edit.end for edit in difference.edits)
        for node in outer_nodes(self.parsed.tree):
            if node.start <= first and last <= node.end:
                return node.start, node.end
        return 0, len(self.text)


def outer_nodes(tree: ProgramNode) -> Iterator[ProgramNode]:
    """Yield the routines and statements that stand in no routine."""
    for node in tree.bodies[0] if tree.bodies else ():
        if node.kind == "module":
            yield from outer_nodes(node)
        else:
            yield node


def _shorter(before: str, after: str, most: int = 70) -> tuple[str, str]:
    """Return both texts without most of their common parts, if they are long."""
    if len(before) <= most and len(after) <= most:
        return before, after
    start = 0
    while start < min(len(before), len(after)) and before[start] == after[start]:
        start += 1
    end = 0
    while end < min(len(before), len(after)) - start and before[-1 - end] == after[-1 - end]:
        end += 1
    first, last = max(0, start - 20), max(0, end - 15)
    head, tail = "…" if first else "", "…" if last else ""
    return (
        f"{head}{before[first : len(before) - last]}{tail}",
        f"{head}{after[first : len(after) - last]}{tail}",
    )
