"""Handle standard output and standard error that are closed, or cannot be written, as on a full disk."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from pathlib import Path
from typing import Any, TextIO, cast

from mutabot.errors import UsageError


class _Stream:
    """A stream that reports what cannot be written.

    Args:
        stream: the stream.
        on_failure: called with it; what it raises ends the command.

    Attributes:
        fault: why something could not be written; None if all could.
    """

    def __init__(self, stream: TextIO, on_failure: Callable[[OSError], None]) -> None:
        self._stream, self._on_failure = stream, on_failure
        self.fault: str | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write a text. Returns its length."""
        try:
            return self._stream.write(text)
        except OSError as error:
            self._failed(error)
            return len(text)

    def flush(self) -> None:
        """Write what is buffered."""
        try:
            self._stream.flush()
        except OSError as error:
            self._failed(error)

    def _failed(self, error: OSError) -> None:
        if not isinstance(error, BrokenPipeError):
            self.fault = error.strerror or str(error)
        self._on_failure(error)


@contextmanager
def guarded_streams() -> Iterator[_Stream]:
    """Raise UsageError if standard output cannot be written; discard what standard error cannot take.

    Gives standard output.
    """
    nowhere = Path(os.devnull)
    out = sys.stdout or nowhere.open("w", encoding="utf-8")  # until the process ends
    err = sys.stderr or nowhere.open("w", encoding="utf-8")  # as above
    output = _Stream(out, output_failed)
    with (
        redirect_stdout(cast("TextIO", output)),
        redirect_stderr(cast("TextIO", _Stream(err, lambda error: _discard(err)))),
    ):
        yield output


def output_failed(error: OSError) -> None:
    """Report that standard output cannot be written; if its reader closed the pipe, raise the error again.

    Raises UsageError, or the error of a pipe.
    """
    if isinstance(error, BrokenPipeError):
        raise error
    _discard(sys.stdout)
    raise UsageError(f"standard output cannot be written: {error.strerror or error}") from error


def _discard(stream: TextIO) -> None:
    """Discard everything buffered or written from now on, which would fail again at the end."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        with suppress(OSError, ValueError):  # of a test there may be no descriptor
            os.dup2(nowhere, stream.fileno())
    finally:
        os.close(nowhere)
