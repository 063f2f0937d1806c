"""Where a process hangs: it writes its stack into a file when it gets a signal, before it is ended."""

from __future__ import annotations

import os
import re
import signal
import time
from itertools import takewhile
from pathlib import Path

#: the signal, one that programs leave alone, and the file in the process's home
SIGNAL, FILE = signal.SIGRTMAX - 2, "stack.txt"
#: seconds to wait for a stack; a process that blocks the signal gives none
_PATIENCE, _STEP = 0.5, 0.02
#: innermost calls to name
_CALLS = 5
_FRAME = re.compile(r'  File "(?P<file>.*)", line (?P<line>\d+) in (?P<function>.*)')
_RUNNER = re.compile(r"/(_pytest|pluggy)/")
#: the inside, and the packages beside the core
_OURS = re.compile(rf"/mutabot/inside/|{re.escape(str(Path(__file__).parents[2]))}/mutabot_|<frozen ")


def ask(pid: int, file: str, root: str) -> str | None:
    """Where this process is, in words; None if it does not say. It must have arranged for the signal.

    Args:
        pid: the process.
        file: the file that it writes its stack to.
        root: the project's folder.
    """
    before = _size(file)
    try:
        os.kill(pid, SIGNAL)
    except (ProcessLookupError, PermissionError):
        return None
    until = time.monotonic() + _PATIENCE
    seen = before
    while time.monotonic() < until:
        time.sleep(_STEP)
        size = _size(file)
        if size > before and size == seen:
            break
        seen = size
    if seen == before:
        return None
    return calls_in_words(Path(file).read_bytes()[before:].decode("utf-8", "replace"), root)


def calls_in_words(text: str, root: str) -> str | None:
    """The innermost calls of the user's in what ``faulthandler`` wrote, innermost first."""
    current = text.rpartition("Current thread")[2]
    frames = [match for line in current.splitlines() if (match := _FRAME.fullmatch(line)) is not None]
    below = takewhile(lambda frame: not _RUNNER.search(frame["file"]), frames)
    users = [frame for frame in below if not _OURS.search(frame["file"])]
    calls = [f"{_short(frame['file'], root)}:{frame['line']} {frame['function']}" for frame in users[:_CALLS]]
    return ", called from ".join(calls) or None


def _short(file: str, root: str) -> str:
    inside = file.startswith(root.rstrip(os.sep) + os.sep)
    return os.path.relpath(file, root) if inside else Path(file).name


def _size(file: str) -> int:
    try:
        return Path(file).stat().st_size
    except OSError:
        return 0
