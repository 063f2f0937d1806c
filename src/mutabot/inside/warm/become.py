"""Becoming a process: what the kernel knows of it, as ``exec`` would have left it."""

from __future__ import annotations

import ctypes
import fcntl
import os
import resource
import signal
import struct
import sys
from contextlib import suppress
from typing import Any

from mutabot.border.start import Start

#: <sys/mman.h>
_PROTECTION, _MAPPING = 3, 0x22  # read and write; private and of no file
#: <linux/prctl.h>
_PR_SET_NAME, _PR_SET_MM, _PR_SET_MM_MAP = 15, 35, 14
#: signals that Python itself ignores from its start on
_IGNORED_BY_PYTHON = (signal.SIGPIPE, signal.SIGXFSZ)
_SPARE = 20


class UnfitError(Exception):
    """The process cannot become what was asked for: it has to be started in the plain way."""


def become(start: Start, descriptors: list[int], kept: int) -> int:
    """Take on all but what is Python's own.

    Args:
        start: what to become.
        descriptors: its folder, what belongs to ``start.targets``, and to ``start.namespaces``.
        kept: one more descriptor that is to stay open.

    Returns the number that ``kept`` has now. Raises OSError or UnfitError if it cannot be.
    """
    folder, *rest = descriptors
    _enter(rest[len(start.targets) :])
    _lead(start)
    for kind, soft, hard in start.limits:
        if resource.getrlimit(kind) != (soft, hard):
            resource.setrlimit(kind, (soft, hard))
    if os.getpriority(os.PRIO_PROCESS, 0) != start.niceness:
        os.setpriority(os.PRIO_PROCESS, 0, start.niceness)
    if os.sched_getaffinity(0) != set(start.processors):
        os.sched_setaffinity(0, start.processors)
    os.umask(start.umask)
    os.fchdir(folder)
    kept = _place(start.targets, rest[: len(start.targets)], kept)
    _show(start)
    _set_environment(start.environment)
    return kept


def _enter(namespaces: list[int]) -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    for descriptor in namespaces:
        if libc.setns(descriptor, 0) != 0:
            raise UnfitError(os.strerror(ctypes.get_errno()))


def _lead(start: Start) -> None:
    """Go to the session and the process group."""
    if start.is_new_session:
        os.setsid()
    elif os.getsid(0) != start.session:
        raise UnfitError("nobody can join another session")
    if start.group >= 0 and start.group != os.getpgid(0):
        os.setpgid(0, start.group)


def _place(targets: tuple[int, ...], sources: list[int], kept: int) -> int:
    """Give descriptors the numbers that they are to have, and close all others."""
    above = max(targets) + _SPARE
    high = [fcntl.fcntl(source, fcntl.F_DUPFD_CLOEXEC, above) for source in [*sources, kept]]
    for source, target in zip(high, targets, strict=False):
        os.dup2(source, target, inheritable=True)
    for name in os.listdir("/proc/self/fd"):
        if int(name) not in targets and int(name) != high[-1]:
            with suppress(OSError):  # that of the listing is gone already
                os.close(int(name))
    return high[-1]


def set_signals(start: Start) -> None:
    """Let signals be ignored and blocked as they are to be; all others do what they do at Python's start."""
    for number in range(1, signal.NSIG):
        is_ignored = bool(start.ignored >> (number - 1) & 1) or number in _IGNORED_BY_PYTHON
        if number == signal.SIGINT:
            wanted: Any = signal.SIG_IGN if is_ignored else signal.default_int_handler
        else:
            wanted = signal.SIG_IGN if is_ignored else signal.SIG_DFL
        with suppress(OSError, ValueError):  # two that cannot be caught, two of the C library's own
            if signal.getsignal(number) is not wanted:
                signal.signal(number, wanted)
    blocked = {number for number in range(1, signal.NSIG) if start.blocked >> (number - 1) & 1}
    signal.pthread_sigmask(signal.SIG_SETMASK, blocked)


def _show(start: Start) -> None:
    """Let the kernel show command line and environment of the new process; UnfitError if it will not."""
    arguments = b"".join(one + b"\0" for one in start.arguments)
    environment = b"".join(one + b"\0" for one in start.environment)
    libc = ctypes.CDLL(None, use_errno=True)
    libc.mmap.restype = libc.sbrk.restype = ctypes.c_void_p
    libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, *[ctypes.c_int] * 3, ctypes.c_long]
    size = len(arguments) + len(environment) + 1
    address = libc.mmap(None, size, _PROTECTION, _MAPPING, -1, 0)
    if address in (None, ctypes.c_void_p(-1).value):
        raise UnfitError("there is no memory for its command line")
    ctypes.memmove(address, arguments + environment, size - 1)
    with open("/proc/self/stat", "rb") as file:
        fields = file.read().rpartition(b")")[2].split()
    code, end_code, stack, data, end_data, heap = (int(fields[n - 3]) for n in (26, 27, 28, 45, 46, 47))
    middle = address + len(arguments)
    bounds = (code, end_code, data, end_data, heap, libc.sbrk(0), stack)
    text = (address, middle, middle, middle + len(environment))
    shown = struct.pack("=12QII", *bounds, *text, 0, 0, 0xFFFFFFFF)
    if libc.prctl(_PR_SET_MM, _PR_SET_MM_MAP, shown, len(shown), 0) != 0:
        raise UnfitError("the kernel shows no other command line")
    libc.prctl(_PR_SET_NAME, start.name[:15], 0, 0, 0)


def _set_environment(entries: tuple[bytes, ...]) -> None:
    values: dict[bytes, bytes] = {}
    for entry in entries:
        name, _, value = entry.partition(b"=")
        values.setdefault(name, value)
    os.environ.clear()
    os.environb.update(values)
    posix: Any = sys.modules["posix"]
    posix.environ.clear()
    posix.environ.update(values)
