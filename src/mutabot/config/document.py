"""A TOML file together with where its keys stand."""

from __future__ import annotations

import contextlib
import re
import tomllib
from bisect import bisect_left
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mutabot import limits
from mutabot.errors import ConfigurationError, VocabularyError

#: the way to a value from the top of a document: keys of tables and indices of lists
KeyPath = tuple[str | int, ...]

_TOO_DEEP = f"is nested too deeply: at most {limits.DEPTH} lists and tables lie in each other"
_TOO_LARGE = (
    f"a whole number beyond 64 bits; it must lie between {limits.LEAST_WHOLE} and {limits.MOST_WHOLE}"
)
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_AT_LINE = re.compile(r" \(at line (\d+), column (\d+)\)$")


@dataclass(frozen=True)
class Document:
    """A TOML file that could be read.

    Attributes:
        file: the file as the user named it.
        data: its content.
        lines: 1-based line of each key.
        error_type: what mistakes in this file are raised as.
    """

    file: str
    data: dict[str, Any]
    lines: Mapping[KeyPath, int] = field(repr=False)
    error_type: type[ConfigurationError] = VocabularyError

    @classmethod
    def read(cls, path: Path, file: str, error_type: type[ConfigurationError] = VocabularyError) -> Document:
        """Read ``path``, which the user knows as ``file``.

        Raises ``error_type`` if it cannot be read, is no TOML, or holds more than can be meant.
        """
        text = ""
        try:
            raw = path.read_bytes()
            if len(raw) > limits.FILE_BYTES:
                problem = f"has {len(raw):,} bytes; at most {limits.FILE_BYTES:,} are read"
                raise error_type(problem, file=file)
            text = raw.decode("utf-8-sig").replace("\r\n", "\n")
            data = tomllib.loads(text)
        except (OSError, RecursionError, ValueError) as error:
            problem, line = _reason(error, text)
            raise error_type(problem, file=file, line=line) from None
        document = cls(file, data, key_lines(text), error_type)
        for place, problem in _extremes(data):
            raise document.error(place, problem)
        return document

    def line(self, place: KeyPath) -> int | None:
        """Line of the key, or of the nearest one around it."""
        for length in range(len(place), 0, -1):
            if place[:length] in self.lines:
                return self.lines[place[:length]]
        return None

    def error(self, place: KeyPath, problem: str) -> ConfigurationError:
        """The error for a problem at this place."""
        return self.error_type(problem, file=self.file, key=self.key(place), line=self.line(place))

    def key(self, place: KeyPath) -> str | None:
        """The place as an engineer would say it: ``robot:Arm.move_by · arguments.dx.unit``."""
        chunks: list[str] = []
        dotted = ""
        node: Any = self.data
        for part in place:
            node = _child(node, part)
            if isinstance(part, str):
                dotted += ("." if dotted else "") + (part if _BARE.fullmatch(part) else f'"{part}"')
                continue
            label = _label(node)
            if label is None:
                dotted += f"#{part + 1}"
            else:
                chunks.append(label if dotted == "operation" else f"{dotted} {label!r}")
                dotted = ""
        return " · ".join([*chunks, dotted] if dotted else chunks) or None


def _extremes(data: Any) -> Iterator[tuple[KeyPath, str]]:
    """What is too deep, too long or too large, whatever it stands for."""
    left: list[tuple[KeyPath, Any]] = [((), data)]
    while left:
        place, value = left.pop()
        if isinstance(value, int) and not limits.LEAST_WHOLE <= value <= limits.MOST_WHOLE:
            yield place, f"is {_TOO_LARGE}"
        if not isinstance(value, dict | list):
            continue
        items = list(value.items()) if isinstance(value, dict) else list(enumerate(value))
        if len(place) > limits.DEPTH:
            yield place[:1], _TOO_DEEP
        elif len(items) > limits.ENTRIES:
            yield place, f"has {len(items)} entries; at most {limits.ENTRIES:,} can be meant"
        else:
            left += [((*place, key), item) for key, item in items]


def _reason(error: Exception, text: str) -> tuple[str, int | None]:
    """Why a file cannot be read, and the line that is to blame, where one is."""
    match error:
        case FileNotFoundError():
            return "there is no such file", None
        case OSError():
            return f"cannot be read: {error.strerror or error}", None
        case UnicodeDecodeError():
            return f"is not UTF-8 text (byte {error.start + 1})", None
        case tomllib.TOMLDecodeError():
            return _syntax(str(error), text)
        case RecursionError():
            return _TOO_DEEP, None
    return f"holds {_TOO_LARGE}", None  # the only other one: Python reads no number of thousands of digits


def _syntax(message: str, text: str) -> tuple[str, int]:
    match = _AT_LINE.search(message)
    if match is None:  # "(at end of document)"
        return f"is no valid TOML: {message}", text.rstrip().count("\n") + 1
    line, column = int(match[1]), int(match[2])
    hint = ""
    if message.startswith("Invalid initial character for a key") and column > len(text.split("\n")[line - 1]):
        hint = "; a table in braces { … } must stand on one line"
    return f"is no valid TOML: {message[: match.start()]} at column {column}{hint}", line


def _child(node: Any, part: str | int) -> Any:
    try:
        return node[part]
    except (KeyError, IndexError, TypeError):
        return None


#: keys whose text names an element
_LABELS = ("call", "text", "topic", "service", "action", "parameter", "timer", "rate", "tf")


def _label(node: Any) -> str | None:
    """What names an element of a list of tables."""
    if not isinstance(node, dict):
        return None
    labels = (node[key] for key in _LABELS if key in node)
    label = next(labels, None)
    return label if isinstance(label, str) and label else None


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
    """The 1-based line of every key, table header and list item of a valid TOML text.

    The standard library's reader does not tell. Where the scan loses its way, it ends with the lines it has.
    """
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
