"""Run tasks in worker processes, and yield their events.

One thread looks after all workers: it waits for events, for exits and for deadlines, and never for one worker
alone. Workers are process groups of their own, so that ending one ends all it started.

The token pool is a pipe with one byte per free token, as many tokens as processes may compute. A fork parent
is started with a token that the controller took for it. From then on it takes and gives back by itself and
says how many it holds, so that the tokens of one that dies are not lost.
"""

from __future__ import annotations

import os
import selectors
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from mutabot.errors import JournalError
from mutabot.execution.cleanup import claim, end_abandoned, end_left_over, remove_folder
from mutabot.execution.interruption import interruptible
from mutabot.execution.processes import (
    LONGEST,
    LOOKS,
    Copy,
    EventStream,
    ForkServerProcess,
    Home,
    Spawned,
    compile_own_modules,
    refuse_full_disk,
)
from mutabot.execution.task import Result, Task
from mutabot.execution.versions import versions
from mutabot.model.deadline import Deadline
from mutabot.model.events import Acted, Event, TestEnd, TestStart, Untrusted
from mutabot.model.fold import Children, acted_in

_BYTE = b"t"
#: after an interruption: how many times longer than expected it may take, and seconds beyond that
_SLOWER, _PATIENCE = 2.0, 30.0
#: bytes that a pipe holds at most
_MOST_TOKENS = 1 << 20


class TokenPool:
    """A pool of ``size`` tokens, all of them free at first."""

    def __init__(self, size: int) -> None:
        self._size = size
        self.reading, self._writing = os.pipe()
        # whatever a test puts there or takes away, nothing may wait for it
        os.set_blocking(self.reading, False)
        os.set_blocking(self._writing, False)
        self.give_back(size)

    @property
    def path(self) -> str:
        """The path by which a fork parent opens the pool for a moment: its tests may count open files."""
        return f"/proc/{os.getpid()}/fd/{self.reading}"

    def take(self, *, beside: int = 0) -> bool:
        """Take a token if more than ``beside`` are free. Return whether it was taken."""
        try:
            taken = len(os.read(self.reading, 1 + beside))
        except BlockingIOError:
            return False
        is_enough = taken > beside
        self.give_back(taken - is_enough)
        return is_enough

    def give_back(self, count: int) -> None:
        """Put tokens back, up to the size of the pool."""
        if count > 0:
            with suppress(BlockingIOError):
                os.write(self._writing, _BYTE * min(count, self._size))

    def refill(self) -> None:
        """Free all tokens; call it only when none is held."""
        with suppress(BlockingIOError):
            os.read(self.reading, _MOST_TOKENS)
        self.give_back(self._size)

    def close(self) -> None:
        """Close both ends."""
        os.close(self.reading)
        os.close(self._writing)


#: said of a process whose own folder was deleted while it ran: what it kept there is lost
_HOME_LOST = Untrusted("the folder in which the tests' process worked was deleted or closed while it ran")


def _work_folder(home: Path) -> Path:
    """Make a folder for this process's workers; end those of killed controllers. Raises JournalError."""
    try:
        home.mkdir(exist_ok=True)
        ignore = home / ".gitignore"
        if not ignore.exists():
            ignore.write_text("*\n", encoding="utf-8")
        end_abandoned(home)
        folder = Path(tempfile.mkdtemp(prefix="work-", dir=home))
        try:
            claim(folder)
        except BaseException:
            remove_folder(folder)
            raise
    except OSError as error:
        raise JournalError(f"cannot write to {home}: {error.strerror}") from error
    return folder


class Workers:
    """Runs tasks in up to ``jobs`` worker processes at a time.

    Args:
        root: the project's root; workers start there.
        arguments: pytest arguments of the project.
        jobs: how many run side by side.
        notify: called once with why tasks do not begin as copies of a fork server, and with what tests leave
            running.

    Use as a context manager: leaving it ends whatever still runs and removes temporary files.

    Attributes:
        pool: the tokens of fork parents and forks.
        look: called several times a second while it waits; what it raises ends the run. None for none.
        spread, remarks: see ``Executor``.
    """

    spread = 1
    remarks: Sequence[str] = ()

    def __init__(
        self,
        root: Path,
        arguments: Iterable[str],
        jobs: int,
        notify: Callable[[str], None] = lambda text: None,
    ) -> None:
        self._root = root
        self._arguments = tuple(arguments)
        self._jobs = max(1, jobs)
        self._selector = selectors.DefaultSelector()
        self._workers: list[_Worker] = []
        self._servers: list[ForkServerProcess] = []
        self._notify, self._has_reported_left = notify, False
        self._may_share = True
        self.pool = TokenPool(self._jobs)
        self.look: Callable[[], None] | None = None
        compile_own_modules()
        self._folder = _work_folder(root / ".mutabot")

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            worker.process.kill()
        for worker in self._workers:
            worker.close(self._selector)
            self._note(worker.left)
        self._workers.clear()
        for server in list(self._servers):
            self._end_server(server)
        self._selector.close()
        self.pool.close()
        remove_folder(self._folder)
        if self._folder.exists():
            self._notify(f"{self._folder} cannot be removed, due to files of a test; no outcome is affected")

    @staticmethod
    def versions() -> dict[str, str]:
        """Return the versions that tasks run with here, by name.

        Python, the type of machine, mutabot and its code, and all packages that are installed beside it.
        Machines on which these are equal give the same outcomes.
        """
        return versions()

    def run(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield results in the order in which tasks end. Tasks are taken when a place is free."""
        for event in self.events(tasks):
            if isinstance(event, Result):
                yield event

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        """Yield events with their tasks as they come, and results in the order in which tasks end."""
        waiting = iter(tasks)
        next_task = next(waiting, None)
        while True:
            while next_task is not None and self._has_place(next_task):
                self._start(next_task)
                next_task = next(waiting, None)
            if next_task is None and not self._workers:
                return
            yield from self._wait(next_task)

    def rest(self, is_awaited: Callable[[], bool], seconds: float) -> Iterator[Result | tuple[Task, Event]]:
        """See ``Executor.rest``."""
        for worker in self._workers:
            worker.home.stop_forks()
        until = time.monotonic() + _SLOWER * seconds + _PATIENCE
        has_notified = False
        while time.monotonic() < until and self._workers:
            if not is_awaited() and not any(worker.home.has_forks for worker in self._workers):
                return
            if not has_notified:
                has_notified = True
                about = f", in about {seconds:.0f} s" if seconds >= 1.0 else ""
                self._notify(
                    "interrupted: what forks have found counts once the original has passed their tests"
                    f"{about}; Ctrl-C again ends at once"
                )
            yield from self._wait(None, LOOKS)

    def apart(self) -> Workers:
        """Return an executor with one more worker process, which shares nothing with these."""
        return Workers(self._root, self._arguments, jobs=1)

    def _note(self, left: list[str] | None) -> None:
        """Report, once, what a process left running."""
        if left and not self._has_reported_left:
            self._has_reported_left = True
            more = f" and {len(left) - 1} more" if len(left) > 1 else ""
            self._notify(f"tests leave processes running, which are ended with them: {left[0]}{more}")

    def _has_place(self, task: Task) -> bool:
        if self._workers and (task.alone or any(worker.task.alone for worker in self._workers)):
            return False
        if len(self._workers) >= self._jobs:
            return False
        if not task.is_fork_parent:
            return True
        if not self._workers:
            self.pool.refill()  # no process is left that could hold one
        return self.pool.take(beside=self._spared)

    @property
    def _spared(self) -> int:
        """The number of tokens reserved for fork parents that have ended no test yet, one for each.

        Outcomes wait until the parent ends the test in which they were forked: what runs beside it puts off
        the first of them.
        """
        return sum(worker.task.is_fork_parent and not worker.result.ends for worker in self._workers)

    def _start(self, task: Task) -> None:
        if task.job.forking is not None:
            forking = replace(task.job.forking, tokens=self.pool.path)
            task = replace(task, job=replace(task.job, forking=forking))
        home = Home.make(self._folder, task.job)
        events = EventStream(home)
        try:
            worker = _Worker(task, home, events, self._process(task, home, events.writing))
        except BaseException:
            events.close()
            raise
        worker.watch(self._selector)
        self._workers.append(worker)

    def _process(self, task: Task, home: Home, writing: int) -> Spawned | Copy:
        server = self._server_for(task) if task.may_share else None
        copy = server.copy(home, writing) if server is not None else None
        if copy is not None:
            return copy
        return Spawned(self._root, self._arguments, home, writing)

    def _server_for(self, task: Task) -> ForkServerProcess | None:
        """Return the fork server for a task; None if there can be none."""
        found = next((server for server in self._servers if server.serves(task.job)), None)
        if found is not None or not self._may_share:
            return found
        for idle in [server for server in self._servers if server.is_idle]:
            self._end_server(idle)  # what it was for is over
        server = ForkServerProcess(task.job, self._root, self._arguments, self._folder)
        self._servers.append(server)
        for descriptor in (server.events.bell, server.process.pidfd):  # with it, its copies end
            self._selector.register(descriptor, selectors.EVENT_READ, server)
        reason = server.wait_until_ready(task.startup.wall, self.look)
        if reason is None:
            return server
        self._may_share = False
        self._notify(f"each run starts anew, imports and collection included: {reason}")
        self._end_server(server)
        return None

    def _end_server(self, server: ForkServerProcess) -> None:
        for descriptor in (server.events.bell, server.process.pidfd):
            self._selector.unregister(descriptor)
        self._servers.remove(server)
        self._note(server.close())

    def _wait(
        self, next_task: Task | None, most: float | None = None
    ) -> Iterator[Result | tuple[Task, Event]]:
        """Wait at most ``most`` seconds for events; ``next_task`` has no place yet."""
        timeout = min((seconds for seconds in (self._patience(), most) if seconds is not None), default=None)
        is_for_token = next_task is not None and next_task.is_fork_parent and len(self._workers) < self._jobs
        # the task for which tokens are spared says when it ends
        is_for_token = is_for_token and not self._spared
        if is_for_token:
            self._selector.register(self.pool.reading, selectors.EVENT_READ, None)
        if self.look is not None:
            self.look()
            timeout = LOOKS if timeout is None else min(timeout, LOOKS)
        try:
            with interruptible():
                ready = self._selector.select(timeout)
        finally:
            if is_for_token:
                self._selector.unregister(self.pool.reading)
        for key, _ in ready:
            if isinstance(key.data, ForkServerProcess):
                key.data.listen()
            elif isinstance(key.data, _Worker) and key.fd == key.data.events.bell:
                for line in key.data.read():
                    yield key.data.task, line
        now = time.monotonic()
        for worker in list(self._workers):
            deadline, process = worker.deadline, worker.process
            if now >= deadline.until and not worker.has_ended and deadline.is_over(process.pid):
                worker.expire()
            if worker.has_ended:
                yield from self._finish(worker)

    def _patience(self) -> float | None:
        """Return the seconds until the next check that no event triggers, at most; None if there is none."""
        if any(worker.has_ended for worker in self._workers):
            return 0.0  # a fork server may have said so while it was asked for something else
        until = min((worker.deadline.until for worker in self._workers), default=None)
        return None if until is None else min(max(0.0, until - time.monotonic()), LONGEST)

    def _finish(self, worker: _Worker) -> Iterator[Result | tuple[Task, Event]]:
        self._workers.remove(worker)
        lines, result = worker.finish(self._selector)
        self._note(worker.left)
        for line in lines:
            yield worker.task, line
        if result.end is None:
            refuse_full_disk(self._folder)
        if worker.task.is_fork_parent:
            self.pool.give_back(result.held)  # what a fork parent that died had not given back itself
        yield result


class _Worker:
    """A running worker process."""

    def __init__(self, task: Task, home: Home, events: EventStream, process: Spawned | Copy) -> None:
        self.task = task
        self.result = Result(task, held=1 if task.is_fork_parent else 0)
        self.events = events
        self.home, self.process = home, process
        self.left: list[str] | None = None
        self._started = time.monotonic()
        self.deadline = Deadline(task.startup)

    @property
    def has_ended(self) -> bool:
        """Whether the process is gone."""
        return self.process.exit_code is not None

    def watch(self, selector: selectors.BaseSelector) -> None:
        selector.register(self.events.bell, selectors.EVENT_READ, self)
        if self.process.pidfd is not None:
            selector.register(self.process.pidfd, selectors.EVENT_READ, self)

    def read(self) -> list[Event]:
        """Read the events that it has written so far."""
        return self._taken(self.events.read())

    def _taken(self, events: list[Event]) -> list[Event]:
        limit = None
        for event in events:
            self.result.take(event)
            if isinstance(event, TestEnd):
                limit = self.task.startup
            elif isinstance(event, TestStart) or self.task.is_fork_parent:
                limit = self.task.deadlines.get(self.result.running or "", self.task.deadline)
        if limit is not None:
            self.deadline = Deadline(limit)
        return events

    def expire(self) -> None:
        """End the process group, whose time is up."""
        deadline = self.deadline
        self.result.hindered, self.result.is_starved = deadline.hindered, deadline.is_starved
        self.result.overdue = deadline.overdue(self.result.running)
        self.process.end()

    def finish(self, selector: selectors.BaseSelector) -> tuple[list[Event], Result]:
        """Collect the last events of a process that has ended, and its result."""
        self.result.exit_code = self._end()
        lines = self._taken([] if self.home.is_whole else [_HOME_LOST])
        lines += self._taken(self.events.read(is_last=True))
        if self.result.find_overdue(time.monotonic()):
            self.result.hindered = self.deadline.used.hindrance()
        if self.result.end is None:
            children = Children(str(self.home.folder), self.home.key)
            children.read()
            lines += self._taken([Acted(test) for test in acted_in(children.records.values())])
            lines += self._taken([Untrusted(children.doubt)] if children.doubt is not None else [])
        self.result.wall = time.monotonic() - self._started + self.process.startup
        self.result.log = self.home.log_text()
        self.close(selector)
        return lines, self.result

    def close(self, selector: selectors.BaseSelector) -> None:
        """Release all resources."""
        selector.unregister(self.events.bell)
        if self.process.pidfd is not None:
            selector.unregister(self.process.pidfd)
        self.events.close()
        self._end()
        self.process.release()
        self.home.remove()

    def _end(self) -> int:
        """End the process and everything started below it. Return its exit code."""
        code = self.process.end()
        if self.left is None:
            left = self.process.left
            self.left = end_left_over(self.home.processes) if left is None else left
        return code
