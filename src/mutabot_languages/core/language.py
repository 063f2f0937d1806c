"""A language: how its files are named, read and run; and what mutabot asks of it, as a front end."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any

from .machine import Dialect, Machine
from .parser import ParsedFile, StatementParser
from .scope import Steps
from .station import Station
from .task import ProgramTask
from .text import SourceText, TextSpan, decode
from .tokens import scan
from .tree import STATEMENTS, ProgramNode, in_short, routines

#: the rest of a file among its units
MODULE = -1
_CALL = Station.call.__code__
#: expressions that may read something of the cell
_EXPRESSIONS = frozenset({"call", "method", "index", "name", "field"})


@dataclass(frozen=True, slots=True)
class RobotLanguage:
    """A language that robot programs are written in.

    Attributes:
        name: what users call it.
        suffixes: how its files end, in small letters.
        parser: of its files.
        dialect: makes what its names mean.
        prepare: makes a run ready, before its first task starts: generators of operations are not allowed.
        main: the steps of the main task, given the run and the name of a routine, which may be empty.
        machine: what runs it.
        task: one of its threads.
        beside: other files that belong to a file by their names.
        share: gives the run of another task what it shares with the first, which is given before it; None if
            a controller runs one task.
    """

    name: str
    suffixes: tuple[str, ...]
    parser: type[StatementParser]
    dialect: Callable[[], Dialect]
    prepare: Callable[[Machine, ProgramTask], Steps]
    main: Callable[[Machine, ProgramTask, str], Steps]
    machine: type[Machine] = Machine
    task: type[ProgramTask] = ProgramTask
    beside: Callable[[Path], list[Path]] = lambda file: []
    share: Callable[[Machine, Machine], None] | None = None

    @property
    def highlighting(self) -> tuple[str, str]:
        """What reports mark in its files, as front ends say it."""
        lexis, keywords = self.parser.lexis, "|".join(sorted(self.parser.keywords))
        patterns = (lexis.marked["text"], lexis.marked["comment"], rf"\b(?:{keywords})\b")
        return "|".join(f"({pattern})" for pattern in patterns), "gim" if lexis.ignores_case else "gm"

    def text_of(self, content: bytes) -> str:
        """Return the text of a file: as UTF-8 if it is that, else as Latin-1."""
        return decode(content)[0]

    def read(self, name: str, text: str) -> ParsedFile:
        """Read a file; what cannot be read is in its diagnostics."""
        return self.parser(SourceText(name, text)).parse()

    def units(self, content: bytes) -> Mapping[str, tuple[int, str, list[TextSpan]]]:
        """Return the bodies of a file's routines, each without those in it, and the rest of the file."""
        parsed = self.read("", self.text_of(content))
        source, tokens = parsed.source, scan(parsed.source.text, self.parser.lexis)
        owners, names = [MODULE] * len(tokens.starts), {MODULE: ""}
        for number, node in enumerate(routines(parsed.tree), 1):
            names[number] = f"{node.name}#{number}" if node.name in names.values() else node.name
            begins = min([body.start for body in node.bodies[0] if body.kind != "empty"], default=node.end)
            first, last = (bisect_left(tokens.starts, item) for item in (begins, node.end))
            owners[first:last] = [number] * (last - first)
        said: dict[int, list[str]] = {number: [] for number in names}
        for owner, kind, start, end in zip(owners, tokens.kinds, tokens.starts, tokens.ends, strict=True):
            word = "\n" if kind == "newline" else source.text[start:end]
            if word != "\n" or said[owner][-1:] not in ([], ["\n"]):  # how many lines are empty is layout
                said[owner].append(word)
        extents: dict[int, list[TextSpan]] = {number: [] for number in names}
        for node in parsed.tree.walk():
            if node is not parsed.tree and node.kind != "empty":
                owner = owners[bisect_left(tokens.starts, node.start)]
                extents[owner].append(source.extent(node.start, node.end))
                said[owner].append(node.kind)  # around a mistake, how a text is read depends on its lines
        return {name: (number, "\0".join(said[number]), extents[number]) for number, name in names.items()}

    def names(self, source: str) -> Mapping[TextSpan, tuple[str, int]]:
        """Return names of all statements, calls and readings in a file."""
        parsed = self.read("", source)
        found = occurrences_in(parsed.tree, source, STATEMENTS | _EXPRESSIONS)
        return {parsed.source.extent(*at): (text, number) for at, (_, text, number) in found.items()}

    def file_of(self, frame: FrameType) -> str | None:
        """Return the file that the machine carries out in its call of the cell; None for all other frames."""
        if frame.f_code is not _CALL:
            return None
        file: str = frame.f_locals["site"].file
        return file if file.lower().endswith(self.suffixes) else None

    def position_of(self, frame: FrameType) -> tuple[TextSpan, str]:
        """Return the part of the program that makes a call of the cell, and its routine."""
        site: Any = frame.f_locals["site"]
        return site.extent, site.routine


#: routine, text and number of each node among those with this text in this routine, by start and end
Occurrences = dict[tuple[int, int], tuple[str, str, int]]


def occurrences_in(tree: ProgramNode, text: str, kinds: frozenset[str] | None = None) -> Occurrences:
    """Return the nodes of a tree, or those of some kinds, that may be a site."""
    counts: dict[tuple[str, str], int] = {}
    found: Occurrences = {}
    waiting: list[tuple[ProgramNode, str]] = [(tree, "<module>")]
    while waiting:
        node, routine = waiting.pop()
        if (node.start, node.end) not in found and (kinds is None or node.kind in kinds):
            shown = site_text(node, text)
            counts[routine, shown] = counts.get((routine, shown), 0) + 1
            found[node.start, node.end] = routine, shown, counts[routine, shown]
        inner = node.name if node.kind == "routine" else routine
        below = [(part, routine) for part in node.parts]
        below += [(statement, inner) for body in node.bodies for statement in body]
        waiting.extend(sorted(below, key=lambda place: place[0].start, reverse=True))
    return found


def site_text(node: ProgramNode, text: str) -> str:
    """Return the name of a site: what is called, or how the node begins."""
    if node.kind in ("call", "method") and node.name:
        return node.name
    return in_short(node, text)
