"""What a worker has left behind when it is gone: processes in sessions of their own.

All that is started below a worker finds the worker's folder in its environment, and the kernel shows with
what environment a process began, whoever its parent is by then. A look at all processes takes about a
millisecond.
"""

from __future__ import annotations

import os
import select
import signal
from contextlib import suppress
from pathlib import Path

from mutabot.border.processes import VARIABLE

#: looks, each after the last one's finds were killed, until nothing is found
_LOOKS = 20
#: milliseconds that killed processes may take to be gone
_PATIENCE = 5000
_PROC = Path("/proc")


def end_left_over(folder: Path) -> int:
    """End every process that was started below the worker of this folder; returns how many there were."""
    entry = os.fsencode(f"{VARIABLE}={folder}")
    ended = 0
    for _ in range(_LOOKS):
        found = [pid for pid in _processes() if _has(pid, entry)]
        if not found:
            break
        ended += sum(_end(pid, entry) for pid in found)
    return ended


def _processes() -> list[int]:
    return [int(name) for name in os.listdir(_PROC) if name.isdigit()]  # noqa: PTH208  # three times as fast


def _has(pid: int, entry: bytes) -> bool:
    """Whether a process began with this in its environment, and is still there."""
    with suppress(OSError), open(f"/proc/{pid}/environ", "rb") as file:  # noqa: PTH123  # likewise
        return entry in file.read().split(b"\0")
    return False


def _end(pid: int, entry: bytes) -> bool:
    """End a process and wait until it is gone; not another that has got its number meanwhile."""
    try:
        process = os.pidfd_open(pid)
    except OSError:
        return False
    try:
        if not _has(pid, entry):
            return False
        with suppress(ProcessLookupError, PermissionError):
            signal.pidfd_send_signal(process, signal.SIGKILL)
        poll = select.poll()
        poll.register(process, select.POLLIN)
        poll.poll(_PATIENCE)
        return True
    finally:
        os.close(process)
