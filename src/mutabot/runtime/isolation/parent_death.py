"""How processes end: none outlives the one it works for, and none takes its memory apart first."""

from __future__ import annotations

import atexit
import ctypes
import os
import select
import signal
import sys
import threading
from contextlib import suppress
from functools import cache
from typing import Any, NoReturn

#: exit code of a process that found nobody to work for
ALONE = 115
_PR_SET_PDEATHSIG = 1  # <linux/prctl.h>


def die_with_parent(parent: int | None = None) -> None:
    """Ask the kernel to end this process when its parent dies; end it now if ``parent`` is already gone."""
    _libc().prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if parent is not None and os.getppid() != parent:  # it died before the kernel was asked
        os._exit(ALONE)


@cache  # ctypes makes a class for each
def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


def nobody_listens(descriptor: int) -> bool:
    """Whether the reading end of a pipe is gone."""
    poll = select.poll()
    poll.register(descriptor, select.POLLERR)
    return any(event & select.POLLERR for _, event in poll.poll(0))


def leave(status: int) -> NoReturn:
    """End this process with this exit code, after the threads and exit handlers that come first."""
    threads: Any = threading
    try:
        threads._shutdown()
        atexit._run_exitfuncs()
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError):
                stream.flush()
    finally:
        os._exit(status)
