"""`os`, `signal`, `atexit` and `socket` for the project's modules: each simulated process has its own."""

from __future__ import annotations

import atexit as real_atexit
import os
import signal as real_signal
import socket as real_socket
from collections.abc import Callable
from types import ModuleType
from typing import Any

from ros_in_process.errors import NeedsRealRos, note
from ros_in_process.machine.imports import provide, with_replacements
from ros_in_process.machine.scheduler import SCHEDULER
from ros_in_process.middleware import signals
from ros_in_process.processes.process import MAIN, STARTED, current, process_of


def _kill(pid: int, signum: int) -> None:
    process = MAIN if pid == os.getpid() else process_of(pid)
    if process is None or (process is MAIN and not _is_handled_here(signum)):
        os.kill(pid, signum)
    elif process.returncode is not None:
        raise ProcessLookupError(3, "No such process")
    else:
        process.send_signal(signum)
        SCHEDULER.pause()


def _is_handled_here(signum: int) -> bool:
    return signals.handles(MAIN, signum) or signum in {*MAIN.handlers, real_signal.SIGINT}


def _exit_now(status: int) -> None:
    process = current()
    if process is MAIN:
        os._exit(status)
    process.finish(status)
    SCHEDULER.end_thread()


def _fork() -> int:
    if current() is MAIN and len(STARTED) == 1:
        return os.fork()
    raise NeedsRealRos("a node forks")


def _os() -> ModuleType:
    """Return `os` without fork hooks: a fork copies simulated threads, so nothing needs repair after it."""
    module = with_replacements(
        "os",
        kill=_kill,
        killpg=_kill,
        getpgid=lambda pid: pid if process_of(pid) else os.getpgid(pid),
        getpid=lambda: current().pid if current() is not MAIN else os.getpid(),
        getppid=_parent_pid,
        _exit=_exit_now,
        fork=_fork,
    )
    module.__dict__.pop("register_at_fork", None)
    return module


def _parent_pid() -> int:
    parent = current().parent
    return os.getppid() if parent is None else parent.pid


def _handle(signum: int, handler: Any) -> Any:
    process = current()
    before = process.handlers.get(signum, real_signal.getsignal(signum))
    process.handlers[int(signum)] = handler
    signals.replaced(process, signum)
    return before


def _signal() -> ModuleType:
    return with_replacements(
        "signal",
        signal=_handle,
        getsignal=lambda signum: current().handlers.get(signum, real_signal.getsignal(signum)),
        raise_signal=lambda signum: _kill(current().pid, signum),
    )


def _at_exit(function: Callable[..., object], *args: Any, **kwargs: Any) -> Callable[..., object]:
    process = current()
    if process is MAIN:
        return real_atexit.register(function, *args, **kwargs)
    process.at_exit.append(lambda: function(*args, **kwargs))
    return function


def _atexit() -> ModuleType:
    return with_replacements("atexit", register=_at_exit)


class Socket(real_socket.socket):
    """A real socket: data arrives in real time."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        note("the project uses sockets, through which things come in real time")
        super().__init__(*args, **kwargs)


def _socket() -> ModuleType:
    return with_replacements("socket", socket=Socket)


def install() -> None:
    """Provide these modules to the modules that see the simulation."""
    for name, build in {"os": _os, "signal": _signal, "atexit": _atexit, "socket": _socket}.items():
        provide(name, build)
