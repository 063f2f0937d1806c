"""The zygote: a process that has imported what others import, and forks Python processes that are asked for.

It is asked over a socket by its parent, see ``border.starter``. One that stands at the beginning of a
campaign learns what its processes import; those that come from it belong to one process each.
"""

from __future__ import annotations

import ctypes
import fcntl
import marshal
import os
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial

from mutabot.border.job import JOB_VARIABLE
from mutabot.border.keeper import guard
from mutabot.border.start import MOST_DESCRIPTORS, Start
from mutabot.border.starter import Starter
from mutabot.inside.fork.lifeline import die_with_parent

from .become import UnfitError, become, set_signals
from .interpreter import forget, make_streams, run_at_exit, set_paths
from .learning import Imports, Library

_BYTES = 1 << 18
#: what a new process says of itself: its number, and a word or why it cannot be
_DIGITS, _WORDS = 12, 900
#: number of the system call ``clone``, by machine
_CLONE = {"x86_64": 56, "aarch64": 220, "riscv64": 220}
#: descriptors of ours in other people's processes are out of the way
_OUT_OF_THE_WAY = 230


def main(imports: Imports) -> None:
    """Serve. It returns in the process that is to become another, which then leaves all frames.

    Args:
        imports: what watches imports, at work; ``sys.argv`` has the socket's number, the file for what is
            learnt, and folders whose modules are the user's own.
    """
    imports.stop()
    _, number, notes, *own = sys.argv
    die_with_parent()
    zygote = Zygote(socket.socket(fileno=int(number)), Library(imports, notes, tuple(own)), is_first=True)
    zygote.serve()


@dataclass(slots=True)
class Zygote:
    """A zygote.

    Attributes:
        channel: the socket over which it is asked.
        library: what it has imported.
        is_first: whether it may still learn, and begins workers.
        controller: the process that it works for.
    """

    channel: socket.socket
    library: Library
    is_first: bool = False
    controller: int = field(default_factory=os.getppid)

    def serve(self) -> None:
        """Fork what is asked for, until nobody can ask any more; returns in what was forked."""
        while True:
            message, descriptors, _, _ = socket.recv_fds(self.channel, _BYTES, MOST_DESCRIPTORS + 10)
            if not message:
                os._exit(0)
            if self.is_first:
                self.library.learn()
            if self._fork(message, descriptors):
                return
            for descriptor in descriptors:
                os.close(descriptor)

    def _fork(self, message: bytes, descriptors: list[int]) -> bool:
        """True in the new process."""
        reading, writing = os.pipe()
        between = os.fork()
        if between == 0:
            pid = os.fork()
            if pid:
                os._exit(0)
            os.close(reading)
            os.write(writing, b"%*d" % (_DIGITS, os.getpid()))
            folder = _folder_of_worker(message) if self.is_first else None
            if folder is not None:
                guard(folder, self.controller)
            self._become(message, descriptors, writing)
            return True
        os.close(writing)
        os.waitpid(between, 0)
        answer = b""
        while data := os.read(reading, 64):
            answer += data
        os.close(reading)
        number = int(answer[:_DIGITS] or 0)
        self.channel.send(b"%d %s" % (number, answer[_DIGITS:] or b"it died"))
        return False

    def _become(self, message: bytes, descriptors: list[int], report: int) -> None:
        self.channel.detach()  # its number will be another's
        try:
            start = Start(*marshal.loads(message))
            self.library.refuse(start)
            report = become(start, descriptors, report)
            self.library.refuse_hidden(start)
            set_signals(start)
            make_streams()
            path = os.environ.get("PYTHONPATH", "")
            set_paths(self.library.base, path)
            if start.may_start and not self._beget():
                return
            forget(self.library.shelf)
            run_at_exit(start, partial(_say_ready, report))
            self.library.open_to(start)
        except Exception as error:  # whatever it is, there is the plain way
            with suppress(OSError):
                os.write(report, (str(error) or type(error).__name__)[:_WORDS].encode("utf-8", "replace"))
            os._exit(1)

    def _beget(self) -> bool:
        """Make a zygote for this process. False in that zygote, once it has become something."""
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        parent = os.getpid()
        if _clone() == 0:
            ours.close()
            die_with_parent(parent)
            _let_go(theirs.fileno())
            self.channel, self.is_first = theirs, False
            self.serve()
            return False
        theirs.close()
        high = fcntl.fcntl(ours, fcntl.F_DUPFD_CLOEXEC, _OUT_OF_THE_WAY)
        ours.close()
        Starter(socket.socket(fileno=high)).install()
        return True


def _folder_of_worker(message: bytes) -> str | None:
    """The folder of the worker that is to begin; None if it is none."""
    entry = f"{JOB_VARIABLE}=".encode()
    found = (one for one in Start(*marshal.loads(message)).environment if one.startswith(entry))
    file = next(found, None)
    return os.path.dirname(os.fsdecode(file[len(entry) :])) if file is not None else None


def _say_ready(report: int) -> None:
    os.write(report, b"ready")
    os.close(report)


def _clone() -> int:
    """Fork a child that ``wait`` does not see."""
    python = ctypes.pythonapi
    libc = ctypes.CDLL(None, use_errno=True)
    number = _CLONE.get(os.uname().machine)
    if number is None:
        raise UnfitError("this machine is not known")
    python.PyOS_BeforeFork()
    pid = int(libc.syscall(number, 0, 0, 0, 0, 0))
    if pid == 0:
        python.PyOS_AfterFork_Child()
    else:
        python.PyOS_AfterFork_Parent()
    if pid < 0:
        raise OSError(ctypes.get_errno(), "no zygote")
    return pid


def _let_go(kept: int) -> None:
    """Hold nothing of the process that this one was forked from."""
    nowhere = os.open(os.devnull, os.O_RDWR)
    for number in range(3):
        os.dup2(nowhere, number)
    for name in os.listdir("/proc/self/fd"):
        if int(name) > 2 and int(name) != kept:
            with suppress(OSError):
                os.close(int(name))
    signal.signal(signal.SIGINT, signal.SIG_DFL)


assert subprocess  # it is to be on the shelf: those who start processes patch it
