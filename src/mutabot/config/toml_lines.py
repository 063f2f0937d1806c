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

_IGNORED = r"(?:[ \t\n]|#[^\n]*)*"
_BLANK = re.compile(_IGNORED)
_OPENED = re.compile(r"(\[{0,2})[ \t]*")
_CLOSED = re.compile(r"\]{1,2}")
_KEY = re.compile(
    r"""(?:(?P<bare>[A-Za-z0-9_-]+)|(?P<quoted>"(?:[^"\\\n]|\\.)*"|'[^'\n]*'))[ \t]*(?P<dot>(?:\.[ \t]*)?)"""
)
_EQUALS = re.compile(r"=[ \t]*")
_PLAIN = re.compile(
    r"""\"""(?:[^\\]|\\.)*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:[^"\\\n]|\\.)*"|'[^'\n]*'|[^,\]}#\n]+""", re.DOTALL
)
_COMMA = re.compile(f"{_IGNORED}(?:,{_IGNORED})?")
_ENDS = {"[": "]", "{": "}"}


def key_lines(text: str) -> dict[KeyPath, int]:
    """The 1-based line of every key, table header and list item of a valid TOML text."""
    scanner = _Scanner(text)
    with contextlib.suppress(ValueError, IndexError, RecursionError):
        scanner.document()
    return scanner.lines


class _Scanner:
    def __init__(self, text: str) -> None:
        self.text, self.position = text, 0
        self.ends = [match.start() for match in re.finditer("\n", text)]
        self.lines: dict[KeyPath, int] = {}
        self.tables: dict[KeyPath, int] = {}  # arrays of tables: how many elements so far

    def document(self) -> None:
        table: KeyPath = ()
        self.take(_BLANK)
        while self.position < len(self.text):
            start, opened = self.position, self.take(_OPENED)[1]
            if opened:
                table = self.header(start, is_list=opened == "[[")
            else:
                self.pair(table)
            self.take(_BLANK)

    def header(self, start: int, *, is_list: bool) -> KeyPath:
        *outer, last = self.key()
        self.take(_CLOSED)
        place: KeyPath = ()
        for key in outer:
            place = self.with_index((*place, key))
        place = (*place, last)
        if is_list:
            self.tables[place] = self.tables.get(place, 0) + 1
        for one in (place, self.with_index(place)):
            self.note(one, start)
        return self.with_index(place)

    def pair(self, table: KeyPath) -> None:
        start = self.position
        place = table + self.key()
        for length in range(len(table) + 1, len(place) + 1):
            self.note(place[:length], start)
        self.take(_EQUALS)
        self.value(place)

    def value(self, place: KeyPath) -> None:
        end = _ENDS.get(self.text[self.position])
        if end is None:
            self.take(_PLAIN)
            return
        self.position += 1
        self.take(_BLANK)
        index = 0
        while self.text[self.position] != end:
            if end == "}":
                self.pair(place)
            else:
                self.note((*place, index), self.position)
                self.value((*place, index))
            index += 1
            self.take(_COMMA)
        self.position += 1

    def key(self) -> KeyPath:
        parts: list[str] = []
        dot = "."
        while dot:
            found = self.take(_KEY)
            parts.append(found["bare"] or tomllib.loads(f"key = {found['quoted']}")["key"])
            dot = found["dot"]
        return tuple(parts)

    def with_index(self, place: KeyPath) -> KeyPath:
        return (*place, self.tables[place] - 1) if place in self.tables else place

    def note(self, place: KeyPath, position: int) -> None:
        self.lines.setdefault(place, bisect_left(self.ends, position) + 1)

    def take(self, pattern: re.Pattern[str]) -> re.Match[str]:
        match = pattern.match(self.text, self.position)
        if match is None:
            raise ValueError("the scan does not understand the text")
        self.position = match.end()
        return match
