"""Whether this process can be forked right now without breaking what it shares with the world."""

from __future__ import annotations

import ctypes
import os
import select
import stat
import sys
from collections.abc import Callable, Iterable
from typing import Any

#: libraries whose loading means that a graphics context may exist, which does not survive a fork
_GRAPHICS = ("libEGL", "libGL.", "libGLX", "libOSMesa", "libvulkan")
_SELF = "/proc/self"
#: how often, and for how many seconds each, to wait for threads that are about to end
_TRIES, _PAUSE = 10, 0.002


def why_not(own_children: Iterable[int], known_sockets: frozenset[int]) -> str | None:
    """Why forking is not safe, in words; None if it is.

    Args:
        own_children: processes that this one forked as branches.
        known_sockets: inodes of sockets that were open before any test ran.
    """
    checks: tuple[Callable[[], str | None], ...] = (
        _threads,
        _event_loop,
        lambda: _subprocesses(set(own_children)),
        lambda: _sockets(known_sockets),
        _graphics,
    )
    return next((reason for check in checks if (reason := check()) is not None), None)


def _threads() -> str | None:
    count = _count_threads()
    threading = sys.modules.get("threading")
    names = [thread.name for thread in threading.enumerate()[1:]] if threading is not None else []
    tries = 0 if names else _TRIES
    while count > 1 and tries > 0:  # one that was joined may take a moment to leave
        select.select([], [], [], _PAUSE)  # a simulation may have taken over time.sleep
        count, tries = _count_threads(), tries - 1
    if count == 1:
        return None
    named = f", such as {names[0]}" if names else ", started by native code"
    return f"{count - 1} more {'thread' if count == 2 else 'threads'}{named}"


def _count_threads() -> int:
    return len(os.listdir(f"{_SELF}/task"))


def _event_loop() -> str | None:
    events = sys.modules.get("asyncio.events")
    running = events is not None and events._get_running_loop() is not None
    return "an asyncio event loop is running" if running else None


def _subprocesses(own: set[int]) -> str | None:
    try:
        with open(f"{_SELF}/task/{os.getpid()}/children", encoding="ascii") as file:
            children = {int(pid) for pid in file.read().split()}
    except OSError:  # a kernel that does not list them
        return None
    others = children - own
    return f"{len(others)} subprocess{'es' if len(others) > 1 else ''} in flight" if others else None


def _sockets(known: frozenset[int]) -> str | None:
    opened = open_sockets() - known
    return f"{len(opened)} open socket{'s' if len(opened) > 1 else ''}" if opened else None


def open_sockets() -> frozenset[int]:
    """Inodes of all sockets this process has open."""
    inodes = set()
    for name in os.listdir(f"{_SELF}/fd"):
        try:
            status = os.fstat(int(name))
        except OSError:  # the descriptor of the listing itself
            continue
        if stat.S_ISSOCK(status.st_mode):
            inodes.add(status.st_ino)
    return frozenset(inodes)


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
