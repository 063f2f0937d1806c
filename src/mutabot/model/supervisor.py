"""The supervisor of a worker: it ends what the worker leaves running, daemons included.

A process whose parent is gone goes to the nearest process above that takes orphans, which is this one. So
neither a session of its own nor an empty environment lets a process escape, and the tests, when they wait for
their children, see none but these. If the controller is gone, the worker and all below it end at once.

It is run as a file by an interpreter that loads nothing else, so it imports little, and nothing of ours.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import time
from contextlib import suppress
from typing import NoReturn

#: this file, as it is run
FILE = os.path.abspath(__file__)
#: in the folder of the worker: what it had left running, one process a line
LEFT = "left"
#: environment variable with the path of the job, in a folder of this one, as ``model.job`` has it
_JOB = "MUTABOT_JOB"
#: seconds that what is about to end may take for that, and in which all must be gone
_GRACE, _PATIENCE = 0.05, 5.0
_PAUSE = 0.002
_WORDS = 80
#: <linux/prctl.h>
_PR_SET_PDEATHSIG, _PR_SET_DUMPABLE, _PR_SET_CHILD_SUBREAPER = 1, 4, 36
#: a child has ended; the controller wants an end; the controller, or a thread of it, has ended
_SIGNALS = {signal.SIGCHLD, signal.SIGTERM, signal.SIGHUP}


def main() -> NoReturn:
    """Run a worker; the arguments are the controller's number and the worker's command line."""
    controller, command = int(sys.argv[1]), sys.argv[2:]
    supervise(os.path.dirname(os.path.dirname(os.environ[_JOB])), controller)
    os.setsid()
    for number in (signal.SIGPIPE, signal.SIGXFSZ):  # Python ignores them, and so would what is executed
        signal.signal(number, signal.SIG_DFL)
    os.execv(command[0], command)


def supervise(folder: str, controller: int) -> None:
    """Fork the worker, in which this function returns; this process supervises it and never returns."""
    libc = ctypes.CDLL(None)
    libc.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
    supervisor = os.getpid()
    worker = os.fork()
    if worker == 0:
        libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
        if os.getppid() != supervisor:
            os._exit(1)
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        return
    with suppress(PermissionError):  # it leads one already
        os.setsid()
    for name in os.listdir("/proc/self/fd"):
        if int(name) > 2:
            with suppress(OSError):  # that of the listing
                os.close(int(name))
    libc.prctl(_PR_SET_PDEATHSIG, signal.SIGHUP, 0, 0, 0)
    _watch(worker, folder, controller)


def _watch(worker: int, folder: str, controller: int) -> NoReturn:
    while (status := _reap(worker)) is None:
        number = signal.sigwait(_SIGNALS)
        if number == signal.SIGTERM or (number == signal.SIGHUP and os.getppid() != controller):
            left = [name_of(pid) for pid in _children() if pid != worker]  # what has got away from it
            status = _end(worker)
            break
    else:
        left = [name_of(pid) for pid in _still_there()]
    _end_others()
    with suppress(OSError), open(os.path.join(folder, LEFT), "w", encoding="utf-8") as file:
        file.writelines(f"{name}\n" for name in left)
    _leave(status)


def _reap(worker: int) -> int | None:
    """Reap all children that have ended. Return the status of the worker if it is among them."""
    found = None
    with suppress(ChildProcessError):
        while (ended := os.waitpid(-1, os.WNOHANG))[0]:
            if ended[0] == worker:
                found = ended[1]
    return found


def _end(worker: int) -> int:
    for end in (os.killpg, os.kill):
        with suppress(ProcessLookupError):  # it may not lead its group yet
            end(worker, signal.SIGKILL)
    return os.waitpid(worker, 0)[1]


def _still_there() -> list[int]:
    """Return the processes that still run a moment after the worker's end."""
    until = time.monotonic() + _GRACE
    while (found := _children()) and time.monotonic() < until:
        time.sleep(_PAUSE)
        _reap(0)
    return found


def _end_others() -> None:
    until = time.monotonic() + _PATIENCE
    while (found := _children()) and time.monotonic() < until:
        for pid in found:  # no other process can have its number as long as it is our child
            os.kill(pid, signal.SIGKILL)
        time.sleep(_PAUSE)
        _reap(0)  # what is below those comes to us


def _children() -> list[int]:
    """Return the children of this process."""
    own = os.getpid()
    try:
        with open(f"/proc/self/task/{own}/children", encoding="ascii") as file:
            return [int(pid) for pid in file.read().split()]
    except OSError:  # a kernel that does not list them
        return [int(name) for name in os.listdir("/proc") if name.isdigit() and _parent(name) == own]


def _parent(pid: str) -> int:
    with suppress(OSError, IndexError), open(f"/proc/{pid}/stat", encoding="utf-8", errors="replace") as file:
        return int(file.read().rpartition(")")[2].split()[1])
    return 0


def name_of(pid: int) -> str:
    """Return the command line and number of a process in one line."""
    command = b""
    with suppress(OSError), open(f"/proc/{pid}/cmdline", "rb") as file:
        command = file.read()
    text = " ".join(command.decode("utf-8", "replace").replace("\0", " ").split())
    printable = "".join(letter if letter.isprintable() else "?" for letter in text)
    return f"{printable[:_WORDS] or 'a process'} ({pid})"


def _leave(status: int) -> NoReturn:
    """End in the same way as the worker."""
    code = os.waitstatus_to_exitcode(status)
    if code >= 0:
        os._exit(code)
    ctypes.CDLL(None).prctl(_PR_SET_DUMPABLE, 0, 0, 0, 0)
    with suppress(OSError):
        signal.signal(-code, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {-code})
    os.kill(os.getpid(), -code)
    os._exit(128 - code)


if __name__ == "__main__":
    main()
