"""Lines on a pipe, each with a seal by which its reader knows that it is whole and from us.

The tests' code can write to any descriptor of its process, by mistake or because a mutant makes it. What is
written so, and a line that it cut in two, has no valid seal. The key of the seal is known to the process
itself, so it is a guard against accidents and not against code that wants to deceive.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from typing import Any

from .codec import shallow
from .lines import Line, Untrusted, line_from_data
from .storable import is_too_deep, to_json

#: bytes of a line; the longest are recordings
MOST_BYTES = 1 << 27
_DIGITS = 16
#: bytes of what cannot be read that are shown
_SHOWN = 60


def framed(line: Line, key: str, default: Callable[[Any], Any]) -> bytes:
    """A line as it goes through the pipe.

    The line break before it ends what a process that was killed while it wrote left unfinished.
    """
    text = to_json({"type": type(line).__name__, **shallow(line)}, default)
    return b"\n" + _seal(text, key) + b" " + text + b"\n"


def unframed(data: bytes, key: str) -> Line:
    """The line that went through the pipe so, without its line breaks; ``Untrusted`` for anything else."""
    text = data[_DIGITS + 1 :]
    if data[_DIGITS : _DIGITS + 1] != b" " or data[:_DIGITS] != _seal(text, key) or is_too_deep(text):
        return unreadable(data)
    try:
        return line_from_data(json.loads(text.decode()))
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
        return unreadable(data)


def unreadable(data: bytes, size: int | None = None) -> Untrusted:
    """What stands for something that is no line; ``size``: its bytes, if this is only its beginning."""
    more = (len(data) if size is None else size) - _SHOWN
    text = f"{data[:_SHOWN]!r}{f' and {more} more bytes' if more > 0 else ''}"
    return Untrusted(f"the tests' process reported something unreadable: {text}")


def _seal(text: bytes, key: str) -> bytes:
    return hashlib.blake2b(text, key=key.encode(), digest_size=_DIGITS // 2).hexdigest().encode()
