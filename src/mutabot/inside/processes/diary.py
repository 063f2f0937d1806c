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
        self._file = os.open(
            os.path.join(folder, f"{os.getpid()}-{int(now * 1e6)}{SUFFIX}"),
            os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC,
            0o600,
        )
        command = tuple(getattr(sys, "orig_argv", sys.argv))
        self.write(Began(os.getpid(), os.getppid(), os.getpgrp(), command, now, test))

    def write(self, entry: Entry) -> None:
        """Write one entry."""
        data = memoryview(to_json({"type": type(entry).__name__, **shallow(entry)}, plain) + b"\n")
        while data:
            data = data[os.write(self._file, data) :]
