"""Where each key of a TOML text is written; the standard library's reader does not tell.

The text is known to be valid TOML, so the scan needs no error handling of its own: where it loses its
way all the same, it ends with the lines it has.
"""

from __future__ import annotations

import contextlib
import re
import tomllib
from bisect import bisect_left

#: the way to a value from the top of a document: keys of tables and indices of lists
KeyPath = tuple[str | int, ...]

_BLANK = re.compile(r"(?:[ \t\n]|#[^\n]*)*")
_SPACE = re.compile(r"[ \t]*")
_KEY = re.compile(r"""(?P<bare>[A-Za-z0-9_-]+)|(?P<quoted>"(?:[^"\\\n]|\\.)*"|'[^'\n]*')""")
_TEXT = re.compile(
    r'''"""(?:[^\\]|\\.)*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:[^"\\\n]|\\.)*"|'[^'\n]*\'''',
    re.DOTALL,
)
_SCALAR = re.compile(r"[^,\]}#\n]+")


def key_lines(text: str) -> dict[KeyPath, int]:
    """The 1-based line of every key, table header and list item of a valid TOML text."""
    scanner = _Scanner(text)
    with contextlib.suppress(_LostError, RecursionError):
        scanner.document()
    return scanner.lines


class _LostError(Exception):
    """The scan does not understand the text."""


class _Scanner:
    def __init__(self, text: str) -> None:
        self.text, self.position = text, 0
        self.ends = [match.start() for match in re.finditer("\n", text)]
        self.lines: dict[KeyPath, int] = {}
        self.tables: dict[KeyPath, int] = {}  # arrays of tables: how many elements so far

    def document(self) -> None:
        table: KeyPath = ()
        while True:
            self.skip(_BLANK)
            if self.position >= len(self.text):
                return
            table = self.header() if self.sees("[") else self.pair(table)

    def header(self) -> KeyPath:
        start = self.position
        is_list = self.sees("[[")
        self.position += 2 if is_list else 1
        self.skip(_SPACE)
        keys = self.key()
        self.skip(_SPACE)
        self.position += 2 if is_list else 1
        place = self.inside_tables(keys[:-1]) + keys[-1:]
        if is_list:
            self.tables[place] = self.tables.get(place, 0) + 1
        self.note(place, start)
        place = self.with_index(place)
        self.note(place, start)
        return place

    def pair(self, table: KeyPath) -> KeyPath:
        start = self.position
        place = table + self.key()
        for length in range(len(table) + 1, len(place) + 1):
            self.note(place[:length], start)
        self.skip(_SPACE)
        self.expect("=")
        self.value(place)
        return table

    def value(self, place: KeyPath) -> None:
        self.skip(_SPACE)
        if self.sees("["):
            self.array(place)
        elif self.sees("{"):
            self.inline_table(place)
        elif self.sees('"') or self.sees("'"):
            self.match(_TEXT)
        else:
            self.match(_SCALAR)

    def array(self, place: KeyPath) -> None:
        self.expect("[")
        index = 0
        self.skip(_BLANK)
        while not self.sees("]"):
            self.note((*place, index), self.position)
            self.value((*place, index))
            index += 1
            self.comma("]")
        self.expect("]")

    def inline_table(self, place: KeyPath) -> None:
        self.expect("{")
        self.skip(_BLANK)
        while not self.sees("}"):
            self.pair(place)
            self.comma("}")
        self.expect("}")

    def comma(self, end: str) -> None:
        self.skip(_BLANK)
        if not self.sees(end):
            self.expect(",")
            self.skip(_BLANK)

    def key(self) -> KeyPath:
        parts: list[str] = []
        while True:
            match = self.match(_KEY)
            bare = match["bare"]
            parts.append(bare if bare is not None else tomllib.loads(f"key = {match['quoted']}")["key"])
            self.skip(_SPACE)
            if not self.sees("."):
                return tuple(parts)
            self.expect(".")
            self.skip(_SPACE)

    def inside_tables(self, keys: KeyPath) -> KeyPath:
        place: KeyPath = ()
        for key in keys:
            place = self.with_index((*place, key))
        return place

    def with_index(self, place: KeyPath) -> KeyPath:
        return (*place, self.tables[place] - 1) if place in self.tables else place

    def note(self, place: KeyPath, position: int) -> None:
        self.lines.setdefault(place, bisect_left(self.ends, position) + 1)

    def sees(self, text: str) -> bool:
        return self.text.startswith(text, self.position)

    def skip(self, pattern: re.Pattern[str]) -> None:
        self.match(pattern)

    def expect(self, text: str) -> None:
        if not self.sees(text):
            raise _LostError
        self.position += len(text)

    def match(self, pattern: re.Pattern[str]) -> re.Match[str]:
        match = pattern.match(self.text, self.position)
        if match is None:
            raise _LostError
        self.position = match.end()
        return match
