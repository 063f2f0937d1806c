"""A TOML file together with where its keys stand; and keys that the command line sets (``-o KEY=VALUE``)."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mutabot import limits
from mutabot.errors import ConfigurationError, UsageError, VocabularyError

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
        text = _text_of(path, file, error_type)
        try:
            data = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise _syntax_error(str(error), text, file, error_type) from None
        except RecursionError:
            raise error_type(_TOO_DEEP, file=file) from None
        except ValueError:  # the only other one: Python reads no whole number of thousands of digits
            raise error_type(f"holds {_TOO_LARGE}", file=file) from None
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


def _text_of(path: Path, file: str, error_type: type[ConfigurationError]) -> str:
    try:
        data = path.read_bytes()
        if len(data) > limits.FILE_BYTES:
            raise error_type(f"has {len(data):,} bytes; at most {limits.FILE_BYTES:,} are read", file=file)
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        problem = f"is not UTF-8 text (byte {error.start + 1})"
        raise error_type(problem, file=file) from None
    except FileNotFoundError:
        raise error_type("there is no such file", file=file) from None
    except OSError as error:
        raise error_type(f"cannot be read: {error.strerror or error}", file=file) from None
    return text.replace("\r\n", "\n")


def _syntax_error(
    message: str, text: str, file: str, error_type: type[ConfigurationError]
) -> ConfigurationError:
    match = _AT_LINE.search(message)
    if match is None:  # "(at end of document)"
        line = text.rstrip().count("\n") + 1
        return error_type(f"is no valid TOML: {message}", file=file, line=line)
    line, column = int(match[1]), int(match[2])
    hint = ""
    if message.startswith("Invalid initial character for a key") and column > len(text.split("\n")[line - 1]):
        hint = "; a table in braces { … } must stand on one line"
    problem = f"is no valid TOML: {message[: match.start()]} at column {column}{hint}"
    return error_type(problem, file=file, line=line)


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


#: parts of a key at most: a table and a key in it
_DEPTH = 2


def overridden(raw: dict[str, Any], texts: Sequence[str], lists: Collection[str]) -> dict[str, Any]:
    """A table of the configuration with what ``KEY=VALUE`` says instead of its own keys.

    A value is written as in TOML; what is no TOML is a text, so ``-o when=once`` needs no quotation marks. A
    text for one of the keys in ``lists`` (``TABLE.KEY`` in a table) is a list of one.

    Raises UsageError for a text that is not of this form.
    """
    found = dict(raw) if texts else raw
    for text in texts:
        key, sign, value = text.partition("=")
        parts = [part.strip() for part in key.split(".")]
        if not sign or not all(parts) or len(parts) > _DEPTH:
            raise UsageError(f"-o {text}: write KEY=VALUE, such as -o rounds=5 or -o cluster.ca=ca.pem")
        table, last = found, parts[-1]
        if len(parts) == _DEPTH:
            inner = found.get(parts[0])
            found[parts[0]] = table = dict(inner) if isinstance(inner, dict) else {}
        given = _value(value.strip())
        table[last] = [given] if ".".join(parts) in lists and isinstance(given, str) else given
    return found


def _value(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (tomllib.TOMLDecodeError, RecursionError, ValueError):
        return text
