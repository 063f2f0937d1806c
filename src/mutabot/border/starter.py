"""Asking a zygote to begin a Python process, so that the process is a child of the one that asks.

The zygote forks twice and lets the process in between end, while the asker is the one to whom orphans go. The
zygote itself was made so that ``wait`` does not see it. What it cannot do goes the plain way.
"""

from __future__ import annotations

import contextlib
import ctypes
import marshal
import os
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

from .start import read_start

#: seconds that a zygote may take; the first of all may be importing what it has learned
_PATIENCE = 60.0
#: versions of Python of which it is known how they begin and end a program
_KNOWN = {(3, 11)}
_MOST_BYTES, _ANSWER_BYTES = 150_000, 1 << 10
#: <linux/prctl.h>
_PR_SET_CHILD_SUBREAPER, _PR_GET_CHILD_SUBREAPER = 36, 37
_NAMESPACES = ("user", "mnt")

ForkExec = Callable[..., int]


@dataclass(slots=True)
class Starter:
    """Starts Python processes by a zygote that is a child of this process.

    Args:
        channel: the socket to the zygote.
        may_start: whether the processes get zygotes of their own.

    Attributes:
        started: how many it has started.
        refused: why others were not, in words, and how many.
    """

    channel: socket.socket
    may_start: bool = False
    started: int = 0
    refused: dict[str, int] = field(default_factory=dict)
    _owner: int = field(default_factory=os.getpid)
    _lock: Any = field(default_factory=threading.Lock)
    _is_lost: bool = False
    _adopted: set[int] = field(default_factory=set)
    _spaces: dict[str, str] = field(default_factory=lambda: dict(namespaces()))

    def fork_exec(self, plain: ForkExec, *arguments: Any) -> int:
        """Like ``_posixsubprocess.fork_exec``, which is ``plain``: the number of the new process."""
        pid = self.start(arguments)
        return plain(*arguments) if pid is None else pid

    def start(self, arguments: tuple[Any, ...]) -> int | None:
        """The number of the new process; None if it is to be started in the plain way."""
        if self._is_lost or os.getpid() != self._owner:
            return None
        changed = tuple(kind for kind, name in namespaces().items() if self._spaces[kind] != name)
        found = read_start(arguments, changed)
        if found is None:
            return None
        start, descriptors = found
        try:
            message = marshal.dumps(replace(start, may_start=self.may_start).data())
            if len(message) > _MOST_BYTES:
                return None
            with self._lock, _opened(changed) as spaces:
                before = _children()
                with _taking_orphans():
                    started = self._ask(message, [*descriptors, *spaces])
                self._adopted |= _children() - before - ({started} if started is not None else set())
                return started
        finally:
            os.close(descriptors[0])

    def _ask(self, message: bytes, descriptors: list[int]) -> int | None:
        try:
            self.channel.settimeout(_PATIENCE)
            socket.send_fds(self.channel, [message], descriptors)
            answer = self.channel.recv(_ANSWER_BYTES)
        except OSError:
            answer = b""
        if not answer:  # it is gone, or hangs
            self._is_lost = True
            self.channel.close()
            return None
        number, _, word = answer.partition(b" ")
        if word == b"ready":
            self.started += 1
            return int(number)
        reason = word.decode("utf-8", "replace")
        self.refused[reason] = self.refused.get(reason, 0) + 1
        if int(number):  # it is a child of ours already, and on its way out
            with contextlib.suppress(ChildProcessError):
                os.waitpid(int(number), 0)
        return None

    def bury(self, seconds: float) -> None:
        """Take note of the ends of processes that were orphaned while one was started, and so came to us.

        Only for a process that starts nothing but by this; waits for so long at most.
        """
        until = time.monotonic() + seconds
        while self._adopted:
            for pid in list(self._adopted):
                with contextlib.suppress(ChildProcessError):
                    if os.waitpid(pid, os.WNOHANG)[0] == 0:
                        continue
                self._adopted.discard(pid)
            if time.monotonic() > until:
                return
            time.sleep(0.005 if self._adopted else 0.0)

    def install(self) -> None:
        """Take over what ``subprocess`` and the spawn method of ``multiprocessing`` start here."""
        import _posixsubprocess  # noqa: PLC0415  # Linux only
        import subprocess  # noqa: PLC0415

        plain = _posixsubprocess.fork_exec

        def fork_exec(*arguments: Any) -> int:
            return self.fork_exec(plain, *arguments)

        _posixsubprocess.fork_exec = fork_exec
        subprocess._fork_exec = fork_exec  # type: ignore[attr-defined]

    @contextmanager
    def at_work(self, before: Sequence[str] = ()) -> Iterator[None]:
        """Take it over for a moment. What goes the plain way gets these words before its command line."""
        import subprocess  # noqa: PLC0415

        module: Any = subprocess
        plain = module._fork_exec
        program = (os.fsencode(before[0]),) if before else None

        def fork_exec(command: list[Any], executables: Any, *arguments: Any) -> int:
            pid = self.start((command, executables, *arguments))
            return plain([*before, *command], program or executables, *arguments) if pid is None else pid

        module._fork_exec = fork_exec
        try:
            yield
        finally:
            module._fork_exec = plain


def namespaces() -> dict[str, str]:
    """The namespaces of this process that it may leave while it lives, by kind."""
    return {kind: os.readlink(f"/proc/self/ns/{kind}") for kind in _NAMESPACES}


def is_supported() -> str | None:
    """Why processes cannot begin by a zygote here, in words; None if they can."""
    if sys.platform != "linux" or sys.implementation.name != "cpython":
        return "it needs CPython on Linux"
    if sys.version_info[:2] not in _KNOWN:
        return f"it is not known how Python {sys.version_info[0]}.{sys.version_info[1]} begins a program"
    return None


@contextmanager
def _opened(kinds: tuple[str, ...]) -> Iterator[list[int]]:
    descriptors = [os.open(f"/proc/self/ns/{kind}", os.O_RDONLY | os.O_CLOEXEC) for kind in kinds]
    try:
        yield descriptors
    finally:
        for descriptor in descriptors:
            os.close(descriptor)


def _children() -> set[int]:
    """The processes whose parent this one is."""
    found: set[int] = set()
    for task in os.listdir("/proc/self/task"):  # pathlib is slow to import
        with contextlib.suppress(OSError), open(f"/proc/self/task/{task}/children", "rb") as file:
            found.update(map(int, file.read().split()))
    return found


@contextmanager
def _taking_orphans() -> Iterator[None]:
    """Be the one to whom orphaned processes below this one go."""
    libc = ctypes.CDLL(None)
    before = ctypes.c_int()
    libc.prctl(_PR_GET_CHILD_SUBREAPER, ctypes.byref(before), 0, 0, 0)
    libc.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    try:
        yield
    finally:
        libc.prctl(_PR_SET_CHILD_SUBREAPER, before.value, 0, 0, 0)
