"""Whether this process can be forked right now without breaking what it shares with the world."""

from __future__ import annotations

import ctypes
import fcntl
import os
import select
import stat
import sys
from collections.abc import Callable, Iterable
from typing import Any

#: libraries whose loading means that a graphics context may exist, which does not survive a fork
_GRAPHICS = ("libEGL", "libGL.", "libGLX", "libOSMesa", "libvulkan")
_SELF = "/proc/self"
#: what threads of LTTng, which comes with ROS 2, wait at
_TRACER = "/dev/shm/lttng-ust-wait"
#: how often, and for how many seconds each, to wait for threads that are about to end
_TRIES, _PAUSE = 10, 0.002


def why_not(own_children: Iterable[int], known: frozenset[int]) -> str | None:
    """Why forking is not safe, in words; None if it is.

    Args:
        own_children: processes that this one forked as branches.
        known: inodes of what was open before the user's code ran, as ``open_now`` gives them.
    """
    checks: tuple[Callable[[], str | None], ...] = (
        _threads,
        _event_loop,
        lambda: subprocesses(own_children),
        lambda: _open_since(known),
        _graphics,
    )
    return next((reason for check in checks if (reason := check()) is not None), None)


def _threads() -> str | None:
    count = count_threads()
    threading = sys.modules.get("threading")
    names = [thread.name for thread in threading.enumerate()[1:]] if threading is not None else []
    tries = 0 if names else _TRIES
    while count > 1 and tries > 0:  # one that was joined may take a moment to leave
        select.select([], [], [], _PAUSE)  # a simulation may have taken over time.sleep
        count, tries = count_threads(), tries - 1
    if count == 1:
        return None
    named = f", such as {names[0]}" if names else ", started by native code"
    return f"{count - 1} more {'thread' if count == 2 else 'threads'}{named}"


def count_threads() -> int:
    """How many threads there are, bar those that wait for a tracer."""
    threads = os.listdir(f"{_SELF}/task")
    if len(threads) == 1:
        return 1
    waiting = _tracer_areas()
    return sum(not _waits_in(thread, waiting) for thread in threads) if waiting else len(threads)


def _tracer_areas() -> list[tuple[int, int]]:
    """Where threads of a tracer wait to be asked. They do nothing until then, so a fork does without."""
    with open(f"{_SELF}/maps", encoding="utf-8", errors="replace") as file:
        areas = [line.split(maxsplit=1)[0].split("-") for line in file if _TRACER in line]
    return [(int(start, 16), int(end, 16)) for start, end in areas]


def _waits_in(thread: str, areas: list[tuple[int, int]]) -> bool:
    try:
        with open(f"{_SELF}/task/{thread}/syscall", encoding="ascii") as file:
            words = file.read().split()
    except OSError:  # it has just ended, or the kernel does not tell
        return False
    if len(words) < 2 or not words[1].startswith("0x"):
        return False
    place = int(words[1], 16)
    return any(start <= place < end for start, end in areas)


def _event_loop() -> str | None:
    events = sys.modules.get("asyncio.events")
    running = events is not None and events._get_running_loop() is not None
    return "an asyncio event loop is running" if running else None


def subprocesses(own: Iterable[int]) -> str | None:
    """How many processes this one has started, in words, bar those of its ``own``; None if there are none."""
    try:
        with open(f"{_SELF}/task/{os.getpid()}/children", encoding="ascii") as file:
            children = {int(pid) for pid in file.read().split()}
    except OSError:  # a kernel that does not list them
        return None
    others = children.difference(own)
    return f"{len(others)} subprocess{'es' if len(others) > 1 else ''} in flight" if others else None


def _open_since(known: frozenset[int]) -> str | None:
    found = _open()
    sockets = {inode for inode, name in found.items() if name is None} - known
    if sockets:
        return f"{len(sockets)} open socket{'s' if len(sockets) > 1 else ''}"
    written = next((name for inode, name in found.items() if name is not None and inode not in known), None)
    return f"{written} is open for writing" if written is not None else None


def open_now() -> frozenset[int]:
    """Inodes of the sockets, and of the files open for writing, that this process has."""
    return frozenset(_open())


def _open() -> dict[int, str | None]:
    """The same with the files' names; sockets have none. Files that were deleted are nobody else's."""
    found: dict[int, str | None] = {}
    for name in os.listdir(f"{_SELF}/fd"):
        try:
            status = os.fstat(int(name))
        except OSError:  # the descriptor of the listing itself
            continue
        if stat.S_ISSOCK(status.st_mode):
            found[status.st_ino] = None
        elif stat.S_ISREG(status.st_mode) and status.st_nlink and _is_written(int(name)):
            found[status.st_ino] = os.readlink(f"{_SELF}/fd/{name}")
    return found


def _is_written(descriptor: int) -> bool:
    return fcntl.fcntl(descriptor, fcntl.F_GETFL) & os.O_ACCMODE != os.O_RDONLY


def _graphics() -> str | None:
    loaded = b"\n".join(loaded_libraries()).decode("utf-8", "replace")
    found = next((name for name in _GRAPHICS if name in loaded), None)
    return f"a graphics library is loaded ({found.rstrip('.')})" if found is not None else None


class _LoadedObject(ctypes.Structure):
    """The beginning of ``struct dl_phdr_info``, <link.h>."""

    _fields_ = (("address", ctypes.c_void_p), ("name", ctypes.c_char_p))


def loaded_libraries() -> list[bytes]:
    """Files of all shared libraries of this process, from the linker; /proc/self/maps takes far longer."""
    names: list[bytes] = []

    def add(found: Any, size: int, data: Any) -> int:
        names.append(found.contents.name or b"")
        return 0

    kind = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(_LoadedObject), ctypes.c_size_t, ctypes.c_void_p)
    ctypes.CDLL(None).dl_iterate_phdr(kind(add), None)
    return names
