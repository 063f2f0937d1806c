"""Reach: what a test can run, under any mutant, told by the names that pieces mention.

From a test's function on, every name that a reached piece mentions (a variable, an attribute, an argument,
text that consists of names) reaches all pieces of that name in the project. What runs at import is reached
by all tests. Where names are computed, everything is reached.
"""

from __future__ import annotations

import hashlib
import re
from collections import defaultdict
from collections.abc import Callable, Iterable

from .mentions import STARTS
from .piece import Kind, Piece
from .project import Project

#: methods that others may call although the project nowhere mentions them beside the object
_PROTOCOLS = {
    "write", "read", "readline", "readlines", "close", "flush", "seek", "fileno", "run", "start", "stop",
    "join", "send", "recv", "get", "put", "acquire", "release", "keys", "items", "values", "handle", "emit",
    "filter", "format", "step", "reset", "render", "update", "default", "encode", "decode", "submit",
    "result", "cancel", "execute", "callback", "notify", "on_next", "throw", "next", "open", "append", "pop",
    "forward", "fit", "predict", "transform",
}  # fmt: skip
#: bases that call nothing of what inherits from them
_QUIET_BASES = {
    "object", "ABC", "Protocol", "NamedTuple", "TypedDict", "Generic", "Enum", "IntEnum", "StrEnum", "Flag",
    "IntFlag",
}  # fmt: skip
_ERROR = re.compile(r"\w*(Error|Exception|Warning)|KeyboardInterrupt|SystemExit|StopIteration")

#: numbers of pieces
Reached = frozenset[int]
#: stands for the text of all files, comments and lines included
_TEXT = -1


class Reach:
    """What tests can run.

    Args:
        project: the Python files.
        everywhere: names that are mentioned outside of them, and reached by all tests.
        starts_processes: whether some test has processes of the program below it.
    """

    def __init__(
        self, project: Project, everywhere: Iterable[str], *, starts_processes: bool = False
    ) -> None:
        self.project = project
        pieces, self._aliases = project.pieces, project.aliases()
        self._by_name: dict[str, list[int]] = defaultdict(list)
        self._by_file: dict[str, list[int]] = defaultdict(list)
        self._mentioned: set[str] = set(everywhere)
        self._classes: dict[str, list[Piece]] = defaultdict(list)
        for number, piece in enumerate(pieces):
            self._by_name[piece.last].append(number)
            self._by_file[piece.file].append(number)
            self._mentioned |= piece.mentions.names
            if piece.kind is Kind.CLASS:
                self._classes[piece.last].append(piece)
        self._methods = {
            (piece.file, piece.name): number
            for number, piece in enumerate(pieces)
            if piece.kind is Kind.FUNCTION
        }
        main = starts_processes or any(
            not piece.mentions.names.isdisjoint(STARTS) for piece in pieces if piece.kind is not Kind.MAIN
        )
        self._common: Reached = frozenset()
        roots = [
            number
            for number, piece in enumerate(pieces)
            if piece.is_root or (main and piece.kind is Kind.MAIN)
        ]
        self._common = self.closure(roots, everywhere)
        self._tests: dict[str, Reached] = {}
        self._digests: dict[int, str] = {}
        self._whole: dict[Reached, str] = {}

    def of_tests(self, tests: Iterable[str], file_of: Callable[[str], str]) -> Reached:
        """What these tests can run."""
        found: set[int] = set(self._common)
        for test in tests:
            if test not in self._tests:
                self._tests[test] = self.closure(*self._begins(file_of(test), test))
            found |= self._tests[test]
        return frozenset(found)

    def at(self, file: str, function: str) -> Reached:
        """What stands where a mutant does, and what that can run."""
        return self.closure(self._at(file, function), ())

    def standing(self, file: str, function: str) -> str:
        """What stands where a mutant does, as a digest."""
        return _together(self._said(number) for number in self._at(file, function))

    def only(self, reached: Reached, wanted: Callable[[str], bool]) -> Reached:
        """Those of these pieces that stand in certain files."""
        pieces = self.project.pieces
        return frozenset(number for number in reached if number == _TEXT or wanted(pieces[number].file))

    def _at(self, file: str, function: str) -> list[int]:
        numbers = self._by_file.get(file, [])
        pieces = self.project.pieces
        name = function.partition(".<locals>")[0]
        own = [number for number in numbers if pieces[number].name == name]
        return own or [number for number in numbers if pieces[number].kind is not Kind.FUNCTION]

    def closure(self, pieces: Iterable[int], names: Iterable[str]) -> Reached:
        """All that is reached from these pieces and names."""
        if _TEXT in self._common:
            return self._common
        everything = False
        found: set[int] = set(self._common)
        seen: set[str] = set()
        waiting, waiting_names = list(pieces), list(names)
        while waiting or waiting_names:
            while waiting_names:
                name = waiting_names.pop()
                if name not in seen:
                    seen.add(name)
                    waiting += self._by_name.get(name, ())
                    waiting_names += self._aliases.get(name, ())
            if not waiting:
                break
            number = waiting.pop()
            if number in found:
                continue
            found.add(number)
            piece = self.project.pieces[number]
            if piece.mentions.text:
                return self._everything | {_TEXT}
            if piece.mentions.any:
                everything = True
            waiting_names += piece.mentions.names
            if piece.kind is Kind.CLASS:
                waiting += self._methods_called(piece)
        return self._everything if everything else frozenset(found)

    @property
    def _everything(self) -> Reached:
        return frozenset(range(len(self.project.pieces)))

    def _begins(self, file: str, test: str) -> tuple[list[int], set[str]]:
        """Where a test begins: its function, what its class inherits, or all of a file that makes tests."""
        numbers = self._by_file.get(file, [])
        parts = [part.partition("[")[0] for part in test.split("::")[1:]]
        name = ".".join(parts)
        own = [number for number in numbers if self.project.pieces[number].name == name]
        names = set(parts[:-1])
        if own:
            return own, names
        if parts and any(piece in self._by_name for piece in parts[-1:]) and len(parts) > 1:
            return [], {*names, *parts}
        return list(numbers), {*names, *parts}

    def _methods_called(self, piece: Piece) -> Iterable[int]:
        """The methods of a class that others may call without mentioning them."""
        is_outside = self._is_outside(piece, set())
        for name in piece.methods:
            is_special = name.startswith("__") and name.endswith("__")
            if is_special or is_outside or name in _PROTOCOLS or name not in self._mentioned:
                yield self._methods[piece.file, f"{piece.name}.{name}"]

    def _is_outside(self, piece: Piece, seen: set[str]) -> bool:
        """Whether a class inherits from one of others, which may call what it does not know."""
        for base in piece.bases:
            if base in seen or base in _QUIET_BASES or _ERROR.fullmatch(base):
                continue
            seen.add(base)
            own = self._classes.get(base)
            if own is None or any(self._is_outside(one, seen) for one in own):
                return True
        return False

    def digest(self, reached: Reached) -> str:
        """What all these pieces say, as a digest."""
        if reached not in self._whole:
            self._whole[reached] = _together(self._said(number) for number in reached)
        return self._whole[reached]

    @property
    def whole(self) -> str:
        """What all pieces say, as a digest."""
        return self.digest(self._everything)

    def files(self, reached: Reached) -> set[str]:
        """The files that hold these pieces."""
        return {self.project.pieces[number].file for number in reached if number != _TEXT}

    def says(self, reached: Reached) -> dict[str, tuple[str, ...]]:
        """What each of these pieces says, by the piece in words."""
        found: dict[str, list[str]] = defaultdict(list)
        for number in sorted(reached):
            shown = self.project.pieces[number].shown if number != _TEXT else "the text of some file"
            found[shown].append(self._said(number)[1])
        return {name: tuple(sorted(said)) for name, said in found.items()}

    def _said(self, number: int) -> tuple[str, str]:
        if number == _TEXT:
            return "", _together(self.project.digests.items())
        piece = self.project.pieces[number]
        if number not in self._digests:
            self._digests[number] = self.project.digest(piece)
        return f"{piece.file}:{piece.name}", self._digests[number]


def _together(said: Iterable[tuple[str, str]]) -> str:
    return hashlib.blake2b(repr(sorted(said)).encode(), digest_size=12).hexdigest()
