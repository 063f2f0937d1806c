"""The file of one process: each entry is written whole and at once, so that nothing is lost with it."""

from __future__ import annotations

import os
import sys
import time

from mutabot.border.codec import shallow
from mutabot.border.processes import SUFFIX, Began, Entry
from mutabot.border.storable import to_json
from mutabot.inside.pipe import plain


class Diary:
    """What a process tells, in the folder of its campaign.

    Args:
        folder: where its file is made.
        test: number of the running test.
    """

    def __init__(self, folder: str, test: int) -> None:
        now = time.monotonic()
        self._path = os.path.join(folder, f"{os.getpid()}-{int(now * 1e6)}{SUFFIX}")
        self._file, self._identity = self._opened()
        command = tuple(getattr(sys, "orig_argv", sys.argv))
        self.write(Began(os.getpid(), os.getppid(), os.getpgrp(), command, now, test))

    def write(self, entry: Entry) -> None:
        """Write one entry."""
        data = memoryview(to_json({"type": type(entry).__name__, **shallow(entry)}, plain) + b"\n")
        if not self._is_open():  # daemons close all that they find open
            self._file, self._identity = self._opened()
        while data:
            data = data[os.write(self._file, data) :]

    def _opened(self) -> tuple[int, tuple[int, int]]:
        file = os.open(self._path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o600)
        status = os.fstat(file)
        return file, (status.st_dev, status.st_ino)

    def _is_open(self) -> bool:
        """Whether the descriptor still leads to the file, and not to another's by now."""
        try:
            status = os.fstat(self._file)
        except OSError:
            return False
        return (status.st_dev, status.st_ino) == self._identity
