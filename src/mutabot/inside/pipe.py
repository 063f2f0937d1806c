"""Report lines out of the process, one JSON object a line."""

from __future__ import annotations

import json
import os
from typing import Any

from mutabot.model.job import Line, line_to_data


class Pipe:
    """The writing end of the pipe to the controller.

    Every line is written whole and at once, so that a process that dies loses only what it had not
    said yet. When nobody listens any more the process has no purpose and ends.
    """

    def __init__(self, descriptor: int) -> None:
        self.descriptor = descriptor
        os.set_inheritable(descriptor, False)

    def send(self, line: Line) -> None:
        """Write one line."""
        text = json.dumps(line_to_data(line), default=plain, separators=(",", ":"))
        data = memoryview(text.encode() + b"\n")
        try:
            while data:
                data = data[os.write(self.descriptor, data) :]
        except BrokenPipeError:
            os._exit(70)


def plain(value: Any) -> Any:
    """JSON-like stand-in for a value that JSON does not know."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, bytes):
        return value.decode("utf-8", "backslashreplace")
    if isinstance(value, set | frozenset | tuple):
        return list(value)
    return repr(value)
