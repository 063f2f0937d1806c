"""The log of a hardware campaign: when what was begun and sent, as appended lines of JSON."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

#: its name in mutabot's folder
NAME = "hardware.jsonl"


class HardwareLog:
    """The log of a project.

    Args:
        file: where it lies; it is made if it is missing.
    """

    def __init__(self, file: Path) -> None:
        self.file = file
        file.touch(mode=0o600)

    def write(self, *, to_disk: bool = True, **data: Any) -> None:
        """Add a line; with ``to_disk``, which takes some milliseconds, it outlives a loss of power."""
        line = json.dumps({"time": time.time(), **data}, default=repr) + "\n"
        descriptor = os.open(self.file, os.O_WRONLY | os.O_APPEND)
        try:
            os.write(descriptor, line.encode())
            if to_disk:
                os.fsync(descriptor)
        finally:
            os.close(descriptor)

    def unfinished(self) -> frozenset[str]:
        """Return the ids of mutants whose last run began but did not end."""
        begun: dict[str, bool] = {}
        for line in self._lines():
            if isinstance(mutant := line.get("mutant"), str):
                begun[mutant] = "begin" in line
        return frozenset(mutant for mutant, is_open in begun.items() if is_open)

    def _lines(self) -> Iterator[dict[str, Any]]:
        with self.file.open(encoding="utf-8", errors="replace") as file:
            for text in file:
                try:
                    line = json.loads(text)
                except ValueError:  # the machine may have gone down within a line
                    continue
                if isinstance(line, dict):
                    yield line
