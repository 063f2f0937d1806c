"""Fork a process, if it can be forked right now without breaking what it shares with the world.

The fork has its parent's process id, and its clock can be set back: both keep from a program what it could
notice of a fork. The id takes a process namespace, whose first process must outlive the others: here one that
sleeps, and shares the parent's memory and files, so that it costs next to nothing. Clone flags and
``clone_args``: <linux/sched.h>.

Event loops of asyncio must wait by descriptors of the fork's own. No process outlives the one it works for,
and none takes its memory apart when it ends.
"""

from __future__ import annotations

import atexit
import ctypes
import errno
import os
import select
import selectors
import signal
import stat
import sys
import threading
import weakref
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import cache
from typing import Any, NamedTuple, NoReturn

import wrapt

_loops: weakref.WeakSet[Any] = weakref.WeakSet()


def track_event_loops() -> None:
    """Note the loops that are made from now on."""
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
    """The loops that are not closed."""
    return [loop for loop in list(_loops) if not loop.is_closed()]


def running_loop() -> Any:
    """The loop that runs in this thread, or None; to be asked before a fork."""
    events = sys.modules.get("asyncio.events")
    return events._get_running_loop() if events is not None else None


def go_on_running(loop: Any) -> None:
    """In a process that was just forked while this loop ran: it runs here, too."""
    if loop is not None:
        events: Any = sys.modules["asyncio.events"]
        events._set_running_loop(loop)
        events.set_event_loop(loop)


def own_event_loops() -> None:
    """In a process that was just forked: every loop waits by descriptors of its own."""
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
#: what tells of processes, and can be asked by any number of them
_HARMLESS = ("/proc/", "anon_inode:[pidfd]", "pidfd:")
#: what threads of LTTng, which comes with ROS 2, wait at
_TRACER = "/dev/shm/lttng-ust-wait"
#: how often, and for how many seconds each, to wait for threads that are about to end
_TRIES, _PAUSE = 10, 0.002


def why_not(own_children: Iterable[int], known: frozenset[tuple[int, str]]) -> str | None:
    """Why forking is not safe, in words; None if it is.

    Args:
        own_children: processes that this one forked for mutants.
        known: what was open before the user's code ran, as ``open_now`` gives it.
    """
    return _threads() or subprocesses(own_children) or _open_since(known) or _graphics()


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
    # threads of a tracer wait to be asked. They do nothing until then, so a fork does without
    areas = [line.split(maxsplit=1)[0].split("-") for line in _maps() if _TRACER in line]
    waiting = [(int(start, 16), int(end, 16)) for start, end in areas]
    return sum(not _waits_in(thread, waiting) for thread in threads) if waiting else len(threads)


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


def subprocesses(own: Iterable[int]) -> str | None:
    """How many processes this one has started, in words, bar those of its ``own``; None if there are none."""
    try:
        with open(f"{_SELF}/task/{os.getpid()}/children", encoding="ascii") as file:
            children = {int(pid) for pid in file.read().split()}
    except OSError:  # a kernel that does not list them
        return None
    others = children.difference(own)
    return f"{len(others)} subprocess{'es' if len(others) > 1 else ''} in flight" if others else None


def _open_since(known: frozenset[tuple[int, str]]) -> str | None:
    ends = (end for loop in open_loops() for end in (loop._ssock, loop._csock, loop._selector))
    loops = {end.fileno() for end in ends if end is not None}
    found = [name for descriptor, name in open_now() - known if descriptor not in loops]
    sockets = sum(name.startswith("socket:") for name in found)
    if sockets:
        return f"{sockets} open socket{'s' if sockets > 1 else ''}"
    return min(found, default=None)


def open_now() -> frozenset[tuple[int, str]]:
    """What of this process a fork would share, bar files and folders, which can be opened again."""
    return frozenset([*_open(), *_shared_memory()])


def _open() -> Iterator[tuple[int, str]]:
    for descriptor, status in descriptors():
        mode, link = status.st_mode, os.readlink(f"{_SELF}/fd/{descriptor}")
        is_file = stat.S_ISREG(mode) or stat.S_ISDIR(mode) or stat.S_ISLNK(mode)
        if not is_file and link not in _NOBODYS and not link.startswith(_HARMLESS):
            yield descriptor, link


def descriptors() -> Iterator[tuple[int, os.stat_result]]:
    """The descriptors that are open, and what they lead to."""
    for name in os.listdir(f"{_SELF}/fd"):
        with suppress(OSError):  # the descriptor of the listing itself
            yield int(name), os.fstat(int(name))


def _shared_memory() -> Iterator[tuple[int, str]]:
    """Memory to which a fork and its parent would both write: where it is, in the place of a descriptor."""
    for line in _maps():
        place, rights = line.split(maxsplit=2)[:2]
        if rights[1] == "w" and rights[3] == "s":
            where = -int(place.partition("-")[0], 16)
            yield where, f"memory shared with others {line[73:].strip()}".rstrip()


def _graphics() -> str | None:
    maps = _maps()
    found = next((name for name in _GRAPHICS if any(name in line for line in maps)), None)
    return f"a graphics library is loaded ({found.rstrip('.')})" if found is not None else None


def _maps() -> list[str]:
    with open(f"{_SELF}/maps", encoding="utf-8", errors="replace") as file:
        return file.readlines()


_CLONE_VM, _CLONE_FILES, _CLONE_NEWTIME, _CLONE_NEWPID = 0x00000100, 0x00000400, 0x00000080, 0x20000000
#: number of this system call on all architectures
_CLONE3 = 435
#: waits for a process whose end raises no signal, so that tests that wait for their own do not see it
_WCLONE = -(1 << 31)
_STACK_BYTES = 1 << 14

_left_out = 0.0


class ForkedPids(NamedTuple):
    """A fork as its parent sees it: its process, and the first one of its namespace; None if it has none."""

    fork: int
    first: int | None


def left_out() -> float:
    """Seconds by which the monotonic clock of this process is behind the system's."""
    return _left_out


def leave_out(seconds: float) -> None:
    """Set the monotonic clock back, here and in all processes that start from now on.

    Raises OSError if that is not possible. To be called while no first process shares this one's memory.
    """
    global _left_out  # noqa: PLW0603  # a process has one clock
    if len(os.listdir("/proc/self/task")) > 1:  # the kernel would refuse when it is too late
        raise OSError(errno.EUSERS, "there are other threads")
    call("unshare", _CLONE_NEWTIME)
    whole, rest = divmod(-round((_left_out + seconds) * 1e9), 10**9)
    with open("/proc/self/timens_offsets", "w", encoding="ascii") as file:
        file.write(f"monotonic {whole} {rest}\nboottime {whole} {rest}\n")
    _enter("/proc/self/ns/time_for_children", _CLONE_NEWTIME)
    _left_out += seconds


@cache
def keeps_ids() -> bool:
    """Whether forks can have the id of this process.

    An ordinary user's process could enter another process namespace, but its later children could not return.
    """
    try:
        _enter("/proc/self/ns/pid", _CLONE_NEWPID)
    except OSError:
        return False
    return True


def asks_for_id(root: str) -> str | None:
    """A file of the project that is loaded and asks for its process's id, as its text says."""
    files = {getattr(module, "__file__", None) or "" for module in list(sys.modules.values())}
    own = (file for file in files if file.startswith(f"{root}/") and "/site-packages/" not in file)
    return next((file[len(root) + 1 :] for file in sorted(own) if _mentions_id(file)), None)


@cache
def _mentions_id(file: str) -> bool:
    try:
        with open(file, "rb") as text:
            return b"getpid" in text.read()
    except OSError:
        return False


def fork() -> ForkedPids | None:
    """Fork a process, with the id of this one if ``keeps_ids``; None in that process.

    Raises OSError if that is not possible.
    """
    if not keeps_ids():
        pid = os.fork()
        return ForkedPids(pid, None) if pid else None
    first = _start_first()
    try:
        _enter(f"/proc/{first}/ns/pid", _CLONE_NEWPID)
        try:
            pid = _fork_as(os.getpid())
        finally:
            _enter("/proc/self/ns/pid", _CLONE_NEWPID)
    except OSError:
        end_first(first)
        raise
    return ForkedPids(pid, first) if pid else None


def end_first(first: int | None) -> None:
    """End the first process of a namespace, if there is one, and with it whatever a fork has left there."""
    if first is not None:
        os.kill(first, signal.SIGKILL)
        os.waitpid(first, _WCLONE)


def _start_first() -> int:
    """Start the first process of a namespace. It wakes up for no signal, and keeps no file open by itself."""
    flags = _CLONE_VM | _CLONE_FILES | _CLONE_NEWPID
    function = ctypes.cast(_libc().pause, ctypes.c_void_p)
    top = (ctypes.addressof(_stack()) + _STACK_BYTES) & ~15
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())
    try:
        return call("clone", function, ctypes.c_void_p(top), flags, None)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _fork_as(pid: int) -> int:
    """Fork, as ``os.fork`` does, a process with this id in its namespace; 0 in it.

    The C library needs to do nothing: this is the only thread, and has the same id there.
    """
    wanted = ctypes.c_int(pid)
    # flags, pidfd, child_tid, parent_tid, exit_signal, stack, stack_size, tls, set_tid, set_tid_size, cgroup
    arguments = (ctypes.c_uint64 * 11)(0, 0, 0, 0, signal.SIGCHLD, 0, 0, 0, ctypes.addressof(wanted), 1, 0)
    ctypes.pythonapi.PyOS_BeforeFork()
    try:
        found = call("syscall", _CLONE3, arguments, ctypes.sizeof(arguments))
    except OSError:
        ctypes.pythonapi.PyOS_AfterFork_Parent()
        raise
    if found:
        ctypes.pythonapi.PyOS_AfterFork_Parent()
    else:
        ctypes.pythonapi.PyOS_AfterFork_Child()
    return found


def _enter(path: str, kind: int) -> None:
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        call("setns", descriptor, kind)
    finally:
        os.close(descriptor)


def call(name: str, *arguments: Any, what: str = "") -> int:
    """Call a function of the C library. Raises OSError, with ``what`` that means if it fails."""
    result: int = getattr(_libc(), name)(*arguments)
    if result < 0:
        number, reason = ctypes.get_errno(), os.strerror(ctypes.get_errno())
        raise OSError(number, f"{what} ({reason})" if what else f"{name}: {reason}")
    return result


@cache
def _libc() -> ctypes.PyDLL:
    return ctypes.PyDLL(None, use_errno=True)  # it keeps Python's lock, as what forks must


@cache
def _stack() -> ctypes.Array[ctypes.c_char]:
    """What all first processes sleep on: none writes to it again once it sleeps."""
    return ctypes.create_string_buffer(_STACK_BYTES)


#: exit code of a process that found nobody to work for
ALONE = 115
_PR_SET_PDEATHSIG = 1  # <linux/prctl.h>


def die_with_parent(parent: int | None = None, pipe: int | None = None) -> None:
    """Ask the kernel to end this process when its parent dies; end it now if that is already gone.

    It is if it is not ``parent``, or if nobody has the reading end of this ``pipe``.
    """
    _libc().prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    # it may have died before the kernel was asked
    if (parent is not None and os.getppid() != parent) or (pipe is not None and _nobody_listens(pipe)):
        os._exit(ALONE)


def _nobody_listens(descriptor: int) -> bool:
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
