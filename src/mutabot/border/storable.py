"""Data that every reader can take, whatever the user's objects hold: what leaves a process is made so here.

Texts become UTF-8 without surrogates, and are cut where they are endless, as are numbers and nesting. Nothing
else is changed: data that is fine already goes through as it is, and data that went through once stays so.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import is_dataclass
from enum import Enum
from typing import Any

from .codec import shallow, to_data

#: the field whose text mutabot itself makes: of no use if it is cut
_WHOLE = "recording"
#: characters of a text, binary digits of a whole number (Python writes 4,300 decimal ones at most), and
#: levels of nesting that are kept
MOST_CHARACTERS, MOST_BITS, MOST_DEPTH = 1 << 18, 14_000, 60
_TEXTS = re.compile(rb'"(?:[^"\\]|\\.)*"')
_NO_BRACKETS = bytes(set(range(256)).difference(b"[]{}"))
#: how JSON in ASCII writes what may be half of a character
_SURROGATE = "\\ud"


def printable(text: str) -> str:
    """The text with ``\\udcff`` in the place of what is no character; any other text as it is."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return text.encode("utf-8", "backslashreplace").decode()
    return text


def to_json(value: Any, default: Callable[[Any], Any]) -> bytes:
    """A value, as ``to_data`` makes it data, as JSON in ASCII that any reader can take.

    ``default`` gives data for what JSON does not know.
    """
    try:
        text = json.dumps(to_data(value), default=default, separators=(",", ":"))
        if _is_fine(text):
            return text.encode()
    except (ValueError, RecursionError, OverflowError):
        pass  # numbers of thousands of digits, objects that hold themselves
    return json.dumps(storable(value, default), separators=(",", ":")).encode()


def is_too_deep(text: bytes) -> bool:
    """Whether JSON is nested deeper than anything that ``to_json`` writes."""
    if text.count(b"[") + text.count(b"{") <= MOST_DEPTH:
        return False
    brackets = _TEXTS.sub(b"", text).translate(None, _NO_BRACKETS)
    for _ in range(MOST_DEPTH + 1):
        if not brackets:
            return False
        brackets = brackets.replace(b"[]", b"").replace(b"{}", b"")
    return bool(brackets)


def _is_fine(text: str) -> bool:
    """Whether JSON needs no second look, which takes far longer."""
    is_short = len(text) <= MOST_CHARACTERS or f'"{_WHOLE}"' in text
    return is_short and _SURROGATE not in text and not is_too_deep(text.encode())


def storable(value: Any, default: Callable[[Any], Any] = repr, depth: int = 0) -> Any:
    """JSON-like data of a value, with all that is endless cut, and with texts that are ``printable``."""
    kind = type(value)
    if value is None or kind is bool or kind is float:
        return value
    if isinstance(value, str):
        return _text(str(value.value if isinstance(value, Enum) else value))
    if isinstance(value, Enum):
        return storable(value.value, default, depth)
    if isinstance(value, int):
        return int(value) if value.bit_length() <= MOST_BITS else _text(f"{int(value):#x}")
    if isinstance(value, float):
        return float(value)
    if depth >= MOST_DEPTH:
        return "… (nested more deeply than mutabot looks)"
    if is_dataclass(kind):
        value = shallow(value)
    if isinstance(value, Mapping):
        return _mapping(value, default, depth + 1)
    if isinstance(value, tuple | list):
        return [storable(item, default, depth + 1) for item in value]
    return storable(default(value), default, depth + 1)


def _mapping(value: Mapping[Any, Any], default: Callable[[Any], Any], depth: int) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, item in value.items():
        name = _text(str(key.value) if isinstance(key, Enum) else str(key))
        while name in found:  # what differed still does
            name += "'"
        is_whole = name == _WHOLE and isinstance(item, str)
        found[name] = printable(item) if is_whole else storable(item, default, depth)
    return found


def _text(text: str) -> str:
    if len(text) > MOST_CHARACTERS:
        text = f"{text[:MOST_CHARACTERS]}… (cut: it has {len(text)} characters)"
    return printable(text)
