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
        reason: why it is left out; None if it is planted.
    """

    operator: str
    node: ProgramNode
    edits: tuple[Edit, ...]
    variant: str = ""
    magnitude: float | None = None
    unit: str | None = None
    note: str = ""
    reason: str | None = None


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

    def shown(self, difference: TextChange) -> str:
        """How the difference reads: ``Offs(p,0,0,100) → Offs(p,0,0,-100)``, the statement in short."""
        before, after = self._statement(difference)
        first, node = difference.edits[0], difference.node
        if first.text in MISSING and (first.start, first.end) == (node.start, node.end):
            return f"{before} deleted"
        before, after = _shorter(before, after)
        return f"{before} → {after}"

    def _statement(self, difference: TextChange) -> tuple[str, str]:
        start, end = difference.node.start, difference.node.end
        for edit in difference.edits:
            start, end = min(start, edit.start), max(end, edit.end)
        inside = [Edit(edit.start - start, edit.end - start, edit.text) for edit in difference.edits]
        part = self.text[start:end]
        return _line(part), _line(applied(part, inside))

    def changed(self, difference: TextChange) -> str:
        """The text of the file as a mutant."""
        return applied(self.text, difference.edits)

    def diff(self, difference: TextChange) -> list[str]:
        """The difference as a unified diff without context: lines without line feeds, else as in the file."""
        old, new = (text.split("\n") for text in (self.text, self.changed(difference)))
        return [*difflib.unified_diff(old, new, f"a/{self.file}", f"b/{self.file}", n=0, lineterm="")]

    def is_sound(self, difference: TextChange) -> bool:
        """Whether the changed text differs and still reads as well as the original does."""
        around = self._around(difference)
        start, end = around
        part = self.text[start:end]
        inside = [Edit(edit.start - start, edit.end - start, edit.text) for edit in difference.edits]
        changed = applied(part, inside)
        if changed == part:
            return False
        before = self.language.read("", part).diagnostics
        return len(self.language.read("", changed).diagnostics) <= len(before)

    def _around(self, difference: TextChange) -> tuple[int, int]:
        """The smallest routine, or statement of the file, that holds all edits."""
        first = min(edit.start for edit in difference.edits)
        last = max(edit.end for edit in difference.edits)
        for node in outer_nodes(self.parsed.tree):
            if node.start <= first and last <= node.end:
                return node.start, node.end
        return 0, len(self.text)


def outer_nodes(tree: ProgramNode) -> Iterator[ProgramNode]:
    """The routines and statements that stand in no routine."""
    for node in tree.bodies[0] if tree.bodies else ():
        if node.kind == "module":
            yield from outer_nodes(node)
        else:
            yield node


def _line(text: str) -> str:
    return " ".join(text.split())


def _shorter(before: str, after: str, most: int = 70) -> tuple[str, str]:
    """Both texts without the most of what they have in common, if they are long."""
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
