"""The server of copies: a session that has collected its tests, and forks a copy of itself for each job.

All that lies before the first test, such as imports and collection, is done once. A copy is cut off from
what it would share, and runs its job like a session of its own. It also does what was to be done at exit
before the fork, which is why its files must be private.
"""

from __future__ import annotations

import contextlib
import gc
import os
import resource
import select
import signal
import socket
import sys
from dataclasses import dataclass, field

from mutabot.frozen import compile_all
from mutabot.model.events import ForkEnded, Serving
from mutabot.runtime.event_file import EventFile
from mutabot.runtime.isolation.files import isolate_files, may_be_private
from mutabot.runtime.isolation.forkable import STARTED, open_now, why_not
from mutabot.runtime.isolation.lifeline import die_with_parent

_MESSAGE_BYTES = 1 << 12


@dataclass(frozen=True, slots=True)
class Commission:
    """What a copy is to do.

    Attributes:
        home: its folder, with the job file in it.
        descriptor: writing end of the pipe by which the controller is told that it has written events.
    """

    home: str
    descriptor: int


@dataclass(slots=True)
class CopyServer:
    """The server's side.

    Attributes:
        descriptor: a socket on which each message is the folder of a job, with the writing end of a pipe.
        pipe: where the server itself reports.
        log_file: what the server prints; every copy gets a file of its own.
        is_private: whether the files of copies are to be private.
    """

    descriptor: int
    pipe: EventFile
    log_file: str
    is_private: bool
    _known: frozenset[tuple[int, str]] = field(default_factory=open_now)
    #: memory of the largest child process that has ended so far, KiB
    _children: int = field(default_factory=lambda: resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
    _copies: dict[int, int] = field(default_factory=dict)

    def serve(self) -> Commission | None:
        """Fork a copy for each job that comes, until no more can come.

        Returns what to do in a copy; None in the server when it is done.
        """
        if resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss != self._children:
            reason: str | None = STARTED  # no job would know of what they did
        elif self.is_private and may_be_private():  # asking that starts a process as well
            reason = why_not((), self._known)
        else:
            reason = "its files are not private"
        if reason is not None:
            self.pipe.send(Serving(reason))
            return None
        compile_all()
        gc.collect()
        gc.freeze()  # what is never looked at stays shared with all copies
        self.pipe.send(Serving())
        with socket.socket(fileno=self.descriptor) as jobs:
            while True:
                if self._wait(jobs):
                    message, descriptors, _, _ = socket.recv_fds(jobs, _MESSAGE_BYTES, 1)
                    if not message:
                        break
                    if self._fork(jobs):
                        return self._commission(os.fsdecode(message), descriptors[0])
                    os.close(descriptors[0])
        for pidfd, pid in list(self._copies.items()):
            self._bury(pidfd, pid)
        return None

    def _wait(self, jobs: socket.socket) -> bool:
        """Sleep until there is a job (True) or copies have ended, and look after these."""
        poll = select.poll()
        poll.register(jobs, select.POLLIN)
        for pidfd in self._copies:
            poll.register(pidfd, select.POLLIN)
        ready = {descriptor for descriptor, _ in poll.poll()}
        for pidfd in ready & self._copies.keys():
            self._bury(pidfd, self._copies[pidfd])
        return jobs.fileno() in ready

    def _bury(self, pidfd: int, pid: int) -> None:
        """End whatever a copy has left running, before its number can go to another process."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(pid, signal.SIGKILL)
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
        _, status = os.waitpid(pid, 0)
        os.close(pidfd)
        del self._copies[pidfd]
        self.pipe.send(ForkEnded(pid, os.waitstatus_to_exitcode(status)))

    def _fork(self, jobs: socket.socket) -> bool:
        """True in the copy."""
        server = os.getpid()
        sys.stdout.flush()
        sys.stderr.flush()
        pid = os.fork()
        if pid:
            self._copies[os.pidfd_open(pid)] = pid
            self.pipe.send(Serving(copy=pid))
            return False
        os.setsid()
        die_with_parent(server)
        jobs.close()
        for pidfd in self._copies:
            os.close(pidfd)
        self.pipe.close()
        return True

    def _commission(self, home: str, descriptor: int) -> Commission:
        old = os.stat(self.log_file)
        log = os.open(os.path.join(home, "log.txt"), os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
        isolate_files((old.st_dev, old.st_ino), log)
        os.close(log)
        return Commission(home, descriptor)
