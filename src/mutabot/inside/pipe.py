"""Report lines out of the process, one JSON object a line."""

from __future__ import annotations

import fcntl
import os
from typing import Any, Protocol

from mutabot.border.frame import framed
from mutabot.border.lines import Line


class Sink(Protocol):
    """Where report lines go."""

    def send(self, line: Line) -> None:
        """Take one line."""


class Pipe:
    """The writing end of the pipe to the controller.

    Every line is written whole and at once, so that a process that dies loses only what it had not
    said yet. When nobody listens any more the process has no purpose and ends.

    Args:
        descriptor: the writing end.
        key: of the seals on the lines.
        lock: descriptor of a file to lock while writing, where a trunk and its branches share the pipe.
    """

    def __init__(self, descriptor: int, key: str = "", lock: int | None = None) -> None:
        self.descriptor = descriptor
        self._key, self._lock = key, lock
        os.set_inheritable(descriptor, False)

    def send(self, line: Line) -> None:
        """Write one line."""
        data = framed(line, self._key, plain)
        if self._lock is None:
            self._write(data)
            return
        fcntl.lockf(self._lock, fcntl.LOCK_EX)
        try:
            self._write(data)
        finally:
            fcntl.lockf(self._lock, fcntl.LOCK_UN)

    def _write(self, data: bytes) -> None:
        view = memoryview(data)
        try:
            while view:
                view = view[os.write(self.descriptor, view) :]
        except BrokenPipeError:
            os._exit(70)


class Held:
    """Stands for the pipe of a process that does not know its job yet: keeps the lines."""

    def __init__(self) -> None:
        self.lines: list[Line] = []

    def send(self, line: Line) -> None:
        """Keep one line."""
        self.lines.append(line)


def plain(value: Any) -> Any:
    """JSON-like stand-in for a value that JSON does not know."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, bytes):
        return value.decode("utf-8", "backslashreplace")
    if isinstance(value, set | frozenset | tuple):
        return list(value)
    return repr(value)
