"""Fork with the parent's process id and a clock of its own, and end with the parent.

The process id and the clock keep from a program what it could notice of a fork. The id takes a process
namespace, whose first process must outlive the others: here one that sleeps, and shares the parent's memory
and files, so that it costs next to nothing. Clone flags and ``clone_args``: <linux/sched.h>. No process
outlives the one it works for, and none takes its memory apart when it ends.
"""

from __future__ import annotations

import atexit
import ctypes
import errno
import os
import select
import signal
import sys
import threading
from contextlib import suppress
from functools import cache
from typing import Any, NamedTuple, NoReturn

from mutabot.model.files import real_open

_CLONE_VM, _CLONE_FILES, _CLONE_NEWTIME, _CLONE_NEWPID = 0x00000100, 0x00000400, 0x00000080, 0x20000000
#: number of this system call on all architectures
_CLONE3 = 435
#: waits for a process whose end raises no signal, so that tests that wait for their own do not see it
_WCLONE = -(1 << 31)
_STACK_BYTES = 1 << 14

_left_out = 0.0


class ForkedPids(NamedTuple):
    """The process id of a fork, and that of the first process of its namespace; None without a namespace."""

    fork: int
    first: int | None


def left_out() -> float:
    """Return the seconds by which this process's monotonic clock is behind the system's."""
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
    with real_open("/proc/self/timens_offsets", "w", encoding="ascii") as file:
        file.write(f"monotonic {whole} {rest}\nboottime {whole} {rest}\n")
    _enter("/proc/self/ns/time_for_children", _CLONE_NEWTIME)
    _left_out += seconds


@cache
def keeps_ids() -> bool:
    """Return whether forks can have the id of this process.

    An ordinary user's process could enter another process namespace, but its later children could not return.
    """
    try:
        _enter("/proc/self/ns/pid", _CLONE_NEWPID)
    except OSError:
        return False
    return True


def asks_for_id(root: str) -> str | None:
    """Return a loaded file of the project whose text asks for the process's id; None if there is none."""
    files = {getattr(module, "__file__", None) or "" for module in list(sys.modules.values())}
    own = (file for file in files if file.startswith(f"{root}/") and "/site-packages/" not in file)
    return next((file[len(root) + 1 :] for file in sorted(own) if _mentions_id(file)), None)


@cache
def _mentions_id(file: str) -> bool:
    try:
        with real_open(file, "rb") as text:
            return b"getpid" in text.read()
    except OSError:
        return False


def fork() -> ForkedPids | None:
    """Fork this process, with its id if ``keeps_ids``. Return None in the fork.

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
    """End the first process of a namespace, if any, and with it every process that a fork has left there."""
    if first is not None:
        os.kill(first, signal.SIGKILL)
        os.waitpid(first, _WCLONE)


def _start_first() -> int:
    """Start the first process of a namespace, which ignores signals and keeps no file open."""
    flags = _CLONE_VM | _CLONE_FILES | _CLONE_NEWPID
    function = ctypes.cast(_libc().pause, ctypes.c_void_p)
    top = (ctypes.addressof(_stack()) + _STACK_BYTES) & ~15
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())
    try:
        return call("clone", function, ctypes.c_void_p(top), flags, None)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _fork_as(pid: int) -> int:
    """Fork a process with this id in its namespace. Return 0 in it, as ``os.fork`` does.

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
    """Call a function of the C library. Raises OSError, whose text has ``what``, if it fails."""
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
    """Return the stack that all first processes share; none writes to it once it sleeps."""
    return ctypes.create_string_buffer(_STACK_BYTES)


#: exit code of a process whose parent had ended
ALONE = 115
_PR_SET_PDEATHSIG = 1  # <linux/prctl.h>


def die_with_parent(parent: int | None = None, pipe: int | None = None) -> None:
    """Ask the kernel to end this process when its parent dies; end it now if the parent is gone.

    It is if it is not ``parent``, or if no process has the reading end of this ``pipe``.
    """
    _libc().prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    # it may have died before the kernel was asked
    if (parent is not None and os.getppid() != parent) or (pipe is not None and _is_unread(pipe)):
        os._exit(ALONE)


def _is_unread(descriptor: int) -> bool:
    poll = select.poll()
    poll.register(descriptor, select.POLLERR)
    return any(event & select.POLLERR for _, event in poll.poll(0))


def leave(status: int) -> NoReturn:
    """End this process with this exit code, after threads and exit handlers have ended."""
    threads: Any = threading
    try:
        threads._shutdown()
        atexit._run_exitfuncs()
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError):
                stream.flush()
    finally:
        os._exit(status)
