"""The controller's side of the fork server: processes that begin where the tests are collected."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import socket
import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

from mutabot.execution.interruption import interruptible
from mutabot.execution.processes import EventStream, Home, Spawned, kill_group
from mutabot.model.events import ForkEnded, Serving
from mutabot.model.job import Job

#: seconds that a server may take to answer, and to end, once its tests are collected
_PATIENCE = 30.0
#: seconds between two looks whether a run is still wanted
LOOKS = 0.2


class Copy:
    """A copy of a fork server, at work on a job. Like ``Spawned``, but it is the server that sees it end."""

    pidfd = None

    def __init__(self, pid: int, server: ForkServer) -> None:
        self.pid, self._server = pid, server
        self.startup = server.startup

    @property
    def tests(self) -> int:
        """The number of the process that runs the tests."""
        return self.pid

    @property
    def left(self) -> None:
        """Nobody but the server's keeper looks after what it leaves."""
        return

    @property
    def exit_code(self) -> int | None:
        """Its exit code, negative for a signal; None while it runs."""
        return self._server.exit_code_of(self.pid)

    def kill(self) -> None:
        """End it and all it has started."""
        if self.exit_code is None:
            kill_group(self.pid)
            with contextlib.suppress(ProcessLookupError):  # it may not lead its group yet
                os.kill(self.pid, signal.SIGKILL)

    def end(self) -> int:
        """End it if it has not ended yet; returns its exit code."""
        self.kill()
        return self._server.wait_for(self.pid)

    def release(self) -> None:
        """Nothing is held of it."""


class ForkServer:
    """A process that has collected the tests, and is copied for each job.

    Args:
        job: a job of the kind that it is to serve.
        root, arguments: as for every worker.
        folder: where its home is made.
        descriptors: what copies inherit.

    Attributes:
        events: what it tells.
        process: the server.
        startup: seconds it took to start.
    """

    def __init__(
        self, job: Job, root: Path, arguments: Iterable[str], folder: Path, descriptors: tuple[int, ...]
    ) -> None:
        self._template = _template(job)
        self._started = time.monotonic()
        self.startup = 0.0
        self.serving: Serving | None = None
        self._copied: int | None = None
        self._codes: dict[int, int | None] = {}
        self._jobs, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            self._home = Home.make(folder, replace(self._template, serving=theirs.fileno()))
            self.events = EventStream(self._home)
            passed = (theirs.fileno(), *descriptors)
            self.process = Spawned(root, arguments, self._home, self.events.writing, passed)

    def serves(self, job: Job) -> bool:
        """Whether a copy can do this job: all that counts before the first test is the same."""
        return _template(job) == self._template

    @property
    def is_idle(self) -> bool:
        """Whether none of its copies is at work."""
        return None not in self._codes.values()

    def wait_until_ready(self, seconds: float, look: Callable[[], None] | None = None) -> str | None:
        """Wait until the tests are collected. Returns why it cannot serve, or None if it can.

        ``look``: called several times a second meanwhile; what it raises ends the wait.
        """

        def is_ready() -> bool:
            if look is not None:
                look()
            return self.serving is not None

        with interruptible():
            self._listen_until(is_ready, seconds, LOOKS if look is not None else seconds)
        self.startup = time.monotonic() - self._started
        if self.serving is None:
            return "the process that was to collect the tests did not get there"
        return self.serving.reason

    def copy(self, home: Home, writing: int) -> Copy | None:
        """A copy that does the job in ``home`` and rings at ``writing``; None if the server is gone."""
        self._copied = None
        try:
            socket.send_fds(self._jobs, [os.fsencode(home.folder)], [writing])
        except OSError:
            return None
        self._listen_until(lambda: self._copied is not None, _PATIENCE)
        return Copy(self._copied, self) if self._copied is not None else None

    def listen(self) -> None:
        """Take in what it reports."""
        for event in self.events.own():
            match event:
                case Serving(copy=int(pid)):
                    self._copied = pid
                    self._codes[pid] = None
                case Serving():
                    self.serving = event
                case ForkEnded():
                    self._codes[event.fork] = event.exit_code

    def exit_code_of(self, pid: int) -> int | None:
        """The exit code of a copy; None while it runs. With the server its copies die."""
        code = self._codes[pid]
        if code is None and self.process.exit_code is not None:
            self.listen()
            code = self._codes[pid]
            return -signal.SIGKILL if code is None else code
        return code

    def wait_for(self, pid: int) -> int:
        """The exit code of a copy that is about to end."""
        self._listen_until(lambda: self._codes[pid] is not None, _PATIENCE)
        if self._codes[pid] is None:  # it cannot be relied on any more
            self.process.kill()
        code = self.exit_code_of(pid)
        return -signal.SIGKILL if code is None else code

    def close(self) -> tuple[list[str], str | None]:
        """End it and all copies; returns what these had left running, and what cannot be removed."""
        self._jobs.close()
        self._listen_until(lambda: False, _PATIENCE if self.serving is not None else 0.0)
        self.process.end()
        self.process.release()
        self.events.close()
        return self.process.left or [], self._home.remove()

    def _listen_until(self, done: Callable[[], bool], seconds: float, period: float = float("inf")) -> None:
        """Listen until something is so, asked once a ``period``, the server has ended, or time is up."""
        until = time.monotonic() + seconds
        poll = select.poll()
        poll.register(self.events.bell, select.POLLIN)
        poll.register(self.process.pidfd, select.POLLIN)
        while not done():
            left = until - time.monotonic()
            if left <= 0:
                return
            ended = self.process.exit_code is not None
            if not ended:
                poll.poll(min(left, period) * 1e3)
            self.listen()
            if ended:
                return


def _template(job: Job) -> Job:
    """What two jobs must have in common to begin as copies of one server."""
    return replace(
        job,
        round=0,
        tests=None,
        mutant=None,
        record=False,
        stop_at_kill=False,
        budgets={},
        moments={},
        inspect=False,
        branching=None,
    )
