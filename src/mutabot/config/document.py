"""A TOML file together with the lines of its keys."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mutabot.errors import ConfigurationError, VocabularyError

#: the way to a value from the top of a document: keys of tables and indices of lists
KeyPath = tuple[str | int, ...]

#: lists in lists and tables in tables; entries of one list or table; bytes of a TOML file
_DEPTH, _ENTRIES, _FILE_BYTES = 32, 10_000, 4_000_000
#: whole numbers of TOML have 64 bits
_LEAST_WHOLE, _MOST_WHOLE = -(2**63), 2**63 - 1
_TOO_DEEP = f"is nested too deeply: at most {_DEPTH} lists and tables lie in each other"
_TOO_LARGE = f"a whole number beyond 64 bits; it must lie between {_LEAST_WHOLE} and {_MOST_WHOLE}"
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
            if len(raw) > _FILE_BYTES:
                problem = f"has {len(raw):,} bytes; at most {_FILE_BYTES:,} are read"
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
        """Return the line of the key, or of the nearest table around it."""
        for length in range(len(place), 0, -1):
            if place[:length] in self.lines:
                return self.lines[place[:length]]
        return None

    def error(self, place: KeyPath, problem: str) -> ConfigurationError:
        """Return the error for a problem at this place."""
        return self.error_type(problem, file=self.file, key=self.key(place), line=self.line(place))

    def key(self, place: KeyPath) -> str | None:
        """Return the place as an engineer would say it: ``robot:Arm.move_by · arguments.dx.unit``."""
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
    """Yield the place and the reason of data that is nested too deeply, too long or too large."""
    left: list[tuple[KeyPath, Any]] = [((), data)]
    while left:
        place, value = left.pop()
        if isinstance(value, int) and not _LEAST_WHOLE <= value <= _MOST_WHOLE:
            yield place, f"is {_TOO_LARGE}"
        if not isinstance(value, dict | list):
            continue
        items = list(value.items()) if isinstance(value, dict) else list(enumerate(value))
        if len(place) > _DEPTH:
            yield place[:1], _TOO_DEEP
        elif len(items) > _ENTRIES:
            yield place, f"has {len(items)} entries; at most {_ENTRIES:,} can be meant"
        else:
            left += [((*place, key), item) for key, item in items]


def _reason(error: Exception, text: str) -> tuple[str, int | None]:
    """Return why a file cannot be read, and the line with the mistake, if known."""
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
        return f"is not valid TOML: {message}", text.rstrip().count("\n") + 1
    line, column = int(match[1]), int(match[2])
    hint = ""
    if message.startswith("Invalid initial character for a key") and column > len(text.split("\n")[line - 1]):
        hint = "; a table in braces { … } must be on one line"
    return f"is not valid TOML: {message[: match.start()]} at column {column}{hint}", line


def _child(node: Any, part: str | int) -> Any:
    try:
        return node[part]
    except (KeyError, IndexError, TypeError):
        return None


#: keys whose text names an element
_LABELS = ("call", "text", "topic", "service", "action", "parameter", "timer", "rate", "tf")


def _label(node: Any) -> str | None:
    """Return what names an element of a list of tables."""
    if not isinstance(node, dict):
        return None
    labels = (node[key] for key in _LABELS if key in node)
    label = next(labels, None)
    return label if isinstance(label, str) and label else None


#: how the last line of a value ends that goes over several lines
_LAST = re.compile(r"""(?:\]|\"""|''')[ \t]*(?:\#.*)?$""")


def key_lines(text: str) -> dict[KeyPath, int]:
    """Return the 1-based line of every key, table header and list item of a valid TOML text.

    The standard library's reader does not say where, so it reads statement by statement. An item of a list
    has a line of its own if each item before it, and it itself, stands on one line.
    """
    lines: dict[KeyPath, int] = {}
    tables: dict[KeyPath, int] = {}  # arrays of tables: how many elements so far
    table: KeyPath = ()
    statement: list[str] = []
    for number, line in enumerate(text.split("\n"), 1):
        statement.append(line)
        is_whole = len(statement) == 1 or _LAST.search(line) is not None
        data = _read("\n".join(statement)) if is_whole else None
        if data is None:
            continue
        if statement[0].lstrip().startswith("["):
            table = _header(data, tables)
            places = [(table[:length], 0) for length in range(1, len(table) + 1)]
        else:
            places = list(_places(data, table, _item_lines(statement)))
        for place, offset in places:
            lines.setdefault(place, number - len(statement) + 1 + offset)
        statement = []
    return lines


def _read(text: str) -> dict[str, Any] | None:
    """Parse a statement; None if it is not complete."""
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError):
        return None


def _header(data: Any, tables: dict[KeyPath, int]) -> KeyPath:
    """Return the place of the table that a header opens; ``tables`` counts elements of lists of tables."""
    place: KeyPath = ()
    while data:
        ((key, data),) = data.items()
        place = (*place, key)
        if isinstance(data, list):
            tables[place] = tables.get(place, 0) + 1
            data = data[0]
        if place in tables:
            place = (*place, tables[place] - 1)
    return place


def _item_lines(statement: list[str]) -> list[int]:
    """Return for each item of a list over several lines how many lines below its key it lies."""
    found: list[int] = []
    last = len(statement) - 1
    for offset, line in enumerate(statement if last else ()):
        start, end = "_ = [" if offset else "", "" if offset == last else "\n]"
        data: Any = _read(start + line + end)
        while isinstance(data, dict) and data:
            (data,) = data.values()
        if not isinstance(data, list):
            break
        found += [offset] * len(data)
    return found


def _places(
    value: Any, place: KeyPath, item_lines: Sequence[int], offset: int = 0
) -> Iterator[tuple[KeyPath, int]]:
    """Yield the places of all parts of a value, each with its number of lines below the key."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield (*place, key), offset
            yield from _places(item, (*place, key), item_lines, offset)
    elif isinstance(value, list):
        for index, item in enumerate(value):
            below = item_lines[index] if index < len(item_lines) else offset
            yield (*place, index), below
            yield from _places(item, (*place, index), (), below)
