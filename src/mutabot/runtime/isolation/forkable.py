"""Decide whether a process can be forked now without breaking what it shares with others.

Event loops of asyncio must wait by descriptors of the fork's own.
"""

from __future__ import annotations

import os
import select
import selectors
import signal
import stat
import sys
import weakref
from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import Any

import wrapt

from mutabot.model.files import real_open

_loops: weakref.WeakSet[Any] = weakref.WeakSet()


def track_event_loops() -> None:
    """Keep track of event loops that are made from now on."""
    # most processes have no loop, and need not import asyncio for it
    wrapt.register_post_import_hook(_track, "asyncio.selector_events")


def _track(selector_events: Any) -> None:
    kind = selector_events.BaseSelectorEventLoop
    make = kind._make_self_pipe

    def made(loop: Any) -> None:
        make(loop)
        _loops.add(loop)

    kind._make_self_pipe = made


def open_loops() -> list[Any]:
    """Return the event loops that are not closed."""
    return [loop for loop in list(_loops) if not loop.is_closed()]


def running_loop() -> Any:
    """Return the loop that runs in this thread, or None; call it before a fork."""
    events = sys.modules.get("asyncio.events")
    return events._get_running_loop() if events is not None else None


def mark_running(loop: Any) -> None:
    """Mark this event loop as running, in a process that was forked while it ran."""
    if loop is not None:
        events: Any = sys.modules["asyncio.events"]
        events._set_running_loop(loop)
        events.set_event_loop(loop)


def own_event_loops() -> None:
    """Give each event loop descriptors of its own, in a process that was just forked."""
    for loop in open_loops():
        old, new = loop._selector, selectors.DefaultSelector()
        for key in list(old.get_map().values()):
            if key.fd != loop._ssock.fileno():
                new.register(key.fileobj, key.events, key.data)
        loop._selector = new
        old.close()
        loop._ssock.close()
        loop._csock.close()
        loop._internal_fds -= 1
        loop._make_self_pipe()


#: why no fork is made where processes have already done their work as the original
STARTED = "processes of the program were started before any test"
#: libraries whose loading means that a graphics context may exist, which does not survive a fork
_GRAPHICS = ("libEGL", "libGL.", "libGLX", "libOSMesa", "libvulkan")
_SELF = "/proc/self"
#: devices that keep nothing
_NOBODYS = ("/dev/null", "/dev/urandom", "/dev/random", "/dev/zero")
#: interfaces about processes, which any number of them can ask
_HARMLESS = ("/proc/", "anon_inode:[pidfd]", "pidfd:")
#: what threads of LTTng, which comes with ROS 2, wait at
_TRACER = "/dev/shm/lttng-ust-wait"
#: how often, and for how many seconds each, to wait for threads that are about to end
_TRIES, _PAUSE = 10, 0.002


def why_not(own_children: Iterable[int], known: frozenset[tuple[int, str]]) -> str | None:
    """Return why forking is not safe; None if it is.

    Args:
        own_children: processes that this one forked for mutants.
        known: what was open before the user's code ran, as ``open_now`` gives it.
    """
    if sys.modules["os"] is not os:
        return "another file system stands in the place of the real one, as by pyfakefs"
    if (busy := _threads() or subprocesses(own_children)) is not None:
        return busy
    if (held := _pending() or _locked()) is not None:
        return held
    maps = _maps()  # which takes a while
    return _open_since(known, maps) or _graphics(maps)


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
    """Return how many threads there are, except those that wait for a tracer."""
    threads = os.listdir(f"{_SELF}/task")
    if len(threads) == 1:
        return 1
    # threads of a tracer wait to be asked. They do nothing until then, so a fork does without
    areas = [line.split(maxsplit=1)[0].split("-") for line in _maps() if _TRACER in line]
    waiting = [(int(start, 16), int(end, 16)) for start, end in areas]
    return sum(not _waits_in(thread, waiting) for thread in threads) if waiting else len(threads)


def _waits_in(thread: str, areas: list[tuple[int, int]]) -> bool:
    try:
        with real_open(f"{_SELF}/task/{thread}/syscall", encoding="ascii") as file:
            fields = file.read().split()
    except OSError:  # it has just ended, or the kernel gives no answer
        return False
    if len(fields) < 2 or not fields[1].startswith("0x"):
        return False
    place = int(fields[1], 16)
    return any(start <= place < end for start, end in areas)


def subprocesses(own: Iterable[int]) -> str | None:
    """Return a text with the number of child processes other than ``own``; None if there are none."""
    try:
        with real_open(f"{_SELF}/task/{os.getpid()}/children", encoding="ascii") as file:
            children = {int(pid) for pid in file.read().split()}
    except OSError:  # a kernel that does not list them
        return None
    others = children.difference(own)
    return f"{len(others)} subprocess{'es' if len(others) > 1 else ''} in flight" if others else None


def _pending() -> str | None:
    names = sorted(str(getattr(number, "name", number)) for number in signal.sigpending())
    return f"a signal that is blocked and waits ({names[0]})" if names else None


def _locked() -> str | None:
    """Return which file this process has locked, as a fork has a file of its own in its place."""
    for descriptor, _ in descriptors():
        with suppress(OSError), real_open(f"{_SELF}/fdinfo/{descriptor}", encoding="ascii") as file:
            if "\nlock:" in file.read():
                return f"a lock on {os.readlink(f'{_SELF}/fd/{descriptor}')}"
    return None


def _open_since(known: frozenset[tuple[int, str]], maps: list[str]) -> str | None:
    ends = (end for loop in open_loops() for end in (loop._ssock, loop._csock, loop._selector))
    loops = {end.fileno() for end in ends if end is not None}
    now = {*_open(), *_shared_memory(maps)}
    found = [name for descriptor, name in now - known if descriptor not in loops]
    sockets = sum(name.startswith("socket:") for name in found)
    if sockets:
        return f"{sockets} open socket{'s' if sockets > 1 else ''}"
    return min(found, default=None)


def open_now() -> frozenset[tuple[int, str]]:
    """Return the open descriptors that a fork would share, except files and folders."""
    return frozenset([*_open(), *_shared_memory(_maps())])


def _open() -> Iterator[tuple[int, str]]:
    for descriptor, status in descriptors():
        mode, link = status.st_mode, os.readlink(f"{_SELF}/fd/{descriptor}")
        is_file = stat.S_ISREG(mode) or stat.S_ISDIR(mode) or stat.S_ISLNK(mode)
        if not is_file and link not in _NOBODYS and not link.startswith(_HARMLESS):
            yield descriptor, link


def descriptors() -> Iterator[tuple[int, os.stat_result]]:
    """Yield the descriptors that are open, and what they lead to."""
    for name in os.listdir(f"{_SELF}/fd"):
        with suppress(OSError):  # the descriptor of the listing itself
            yield int(name), os.fstat(int(name))


def _shared_memory(maps: list[str]) -> Iterator[tuple[int, str]]:
    """Yield shared writable memory, with its address in the place of a descriptor."""
    for line in maps:
        place, rights = line.split(maxsplit=2)[:2]
        if rights[1] == "w" and rights[3] == "s":
            where = -int(place.partition("-")[0], 16)
            yield where, f"memory shared with others {line[73:].strip()}".rstrip()


def _graphics(maps: list[str]) -> str | None:
    found = next((name for name in _GRAPHICS if any(name in line for line in maps)), None)
    return f"a graphics library is loaded ({found.rstrip('.')})" if found is not None else None


def _maps() -> list[str]:
    with real_open(f"{_SELF}/maps", encoding="utf-8", errors="replace") as file:
        return file.readlines()
