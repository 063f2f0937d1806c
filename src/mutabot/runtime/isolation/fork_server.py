"""The fork server, a session that has collected its tests and forks a copy of itself for each job.

All that lies before the first test, such as imports and collection, is done once. A copy is cut off from
what it would share, and runs its job like a session of its own. It also does what was to be done at exit
before the fork, which is why its files must be private.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import socket
import sys
from dataclasses import dataclass, field

from mutabot.frozen import compile_all
from mutabot.model.events import ForkEnded, Serving
from mutabot.model.files import open_file
from mutabot.runtime.event_file import EventFile
from mutabot.runtime.isolation import collector
from mutabot.runtime.isolation.files import isolate_files, may_be_private
from mutabot.runtime.isolation.forkable import STARTED, open_now, why_not
from mutabot.runtime.isolation.namespaces import die_with_parent
from mutabot.shared_memory import SharedMemory

_MESSAGE_BYTES = 1 << 12
#: what a copy is to do: its folder with the job file in it, and the writing end of the pipe by which the
#: controller learns that there are events
ForkRequest = tuple[str, int]


@dataclass(slots=True)
class ForkServer:
    """The server in its own process.

    Attributes:
        descriptor: a socket on which each message is the folder of a job, with the writing end of a pipe.
        event_file: where the server itself reports.
        log: name of the file for what a process prints, in its folder.
        home: the server's folder.
        is_private: whether the files of copies are to be private.
        may_remember: whether copies may share a memory of what they compute.
    """

    descriptor: int
    event_file: EventFile
    log: str
    home: str
    is_private: bool
    may_remember: bool
    _known: frozenset[tuple[int, str]] = field(default_factory=open_now)
    _copies: dict[int, int] = field(default_factory=dict)

    def serve(self, has_started: bool) -> ForkRequest | None:
        """Fork a copy for each job that comes, until no more can come. Return the request in a copy.

        ``has_started``: whether the program has started processes by now, of which no job would know.
        Returns what to do in a copy; None in the server when it is done.
        """
        reason = STARTED if has_started else None
        if reason is None and not (self.is_private and may_be_private()):
            reason = "its files are not private"
        reason = reason or why_not((), self._known)
        self.event_file.send(Serving(reason))
        if reason is not None:
            return None
        if self.may_remember:
            SharedMemory.share()
        compile_all()
        collector.freeze()
        with socket.socket(fileno=self.descriptor) as jobs:
            while True:
                if not self._wait(jobs):
                    continue
                message, descriptors, _, _ = socket.recv_fds(jobs, _MESSAGE_BYTES, 1)
                if not message:
                    break
                if self._fork(jobs):
                    return self._begin(os.fsdecode(message)), descriptors[0]
                os.close(descriptors[0])
        for pidfd in list(self._copies):
            self._end_leftovers(pidfd)
        return None

    def _wait(self, jobs: socket.socket) -> bool:
        """Wait until there is a job, and return True, or reap copies that have ended."""
        poll = select.poll()
        for descriptor in (jobs.fileno(), *self._copies):
            poll.register(descriptor, select.POLLIN)
        ready = {descriptor for descriptor, _ in poll.poll()}
        for pidfd in ready & self._copies.keys():
            self._end_leftovers(pidfd)
        return jobs.fileno() in ready

    def _end_leftovers(self, pidfd: int) -> None:
        """End whatever a copy has left running, before another process can get its number."""
        pid = self._copies.pop(pidfd)
        for end in (os.killpg, os.kill):
            with contextlib.suppress(ProcessLookupError, PermissionError):
                end(pid, signal.SIGKILL)
        _, status = os.waitpid(pid, 0)
        os.close(pidfd)
        self.event_file.send(ForkEnded(pid, os.waitstatus_to_exitcode(status)))

    def _fork(self, jobs: socket.socket) -> bool:
        """Fork for the next job. Return True in the copy."""
        server = os.getpid()
        sys.stdout.flush()
        sys.stderr.flush()
        pid = os.fork()
        if pid:
            self._copies[os.pidfd_open(pid)] = pid
            self.event_file.send(Serving(copy=pid))
            return False
        os.setsid()
        die_with_parent(server)
        jobs.close()
        for pidfd in self._copies:
            os.close(pidfd)
        self.event_file.close()
        return True

    def _begin(self, home: str) -> str:
        """Redirect the copy's output into its own folder, and return the folder."""
        old = os.stat(os.path.join(self.home, self.log))
        log = open_file(os.path.join(home, self.log), os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        isolate_files(old, log)
        os.close(log)
        return home
