"""A TOML file together with where its keys stand."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mutabot import limits
from mutabot.errors import ConfigurationError, VocabularyError

from .toml_lines import KeyPath, key_lines

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
            text = _text_of(path)
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


def _text_of(path: Path) -> str:
    """The text of a file. Raises OSError or ValueError if it cannot be read."""
    data = path.read_bytes()
    if len(data) > limits.FILE_BYTES:
        raise _TooLargeError(f"has {len(data):,} bytes; at most {limits.FILE_BYTES:,} are read")
    return data.decode("utf-8-sig").replace("\r\n", "\n")


class _TooLargeError(ValueError):
    """A file is too large to be read."""


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
        case _TooLargeError():
            return str(error), None
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
