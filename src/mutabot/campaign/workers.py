"""Worker processes: each runs one job in a fresh Python and answers over a pipe.

One thread looks after all of them: it waits for lines, for exits and for deadlines, and never for one
worker alone. Workers are process groups of their own, so that ending one ends all it started.
"""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Any

from mutabot.errors import JournalError
from mutabot.model import (
    Acted,
    Job,
    MutatedCall,
    NotInstrumented,
    PlacesReached,
    Problem,
    SessionEnd,
    SiteSeen,
    TestEnd,
    TestStart,
    TextsSeen,
    TokensHeld,
    to_data,
)
from mutabot.model.job import JOB_VARIABLE, PIPE_VARIABLE, Line, line_from_data

from .tokens import TokenPool

#: plug-ins that would run tests elsewhere, again, or in another order, and how to stop each
_SWITCHED_OFF = {
    "xdist": ("-p", "no:xdist"),
    "pytest_rerunfailures": ("-p", "no:rerunfailures"),
    "flaky": ("-p", "no:flaky"),
    "pytest_randomly": ("-p", "no:randomly"),
    "pytest_random_order": ("-p", "no:random_order"),
    "pytest_cov": ("-p", "no:cov"),
}
#: seconds a worker may take until its first test begins, at least
STARTUP_SECONDS = 60.0


@dataclass(frozen=True, slots=True)
class Task:
    """A job with what the controller needs to run it.

    Attributes:
        key: what the caller knows it by.
        job: the job.
        deadlines: wall-clock seconds each test may take; tests that are missing get ``deadline``.
        deadline: wall-clock seconds for any other test.
        startup: wall-clock seconds until the first test begins.
        is_trunk: whether it branches: it then runs on a token of the pool.
    """

    key: Any
    job: Job
    deadlines: Mapping[str, float] = field(default_factory=dict)
    deadline: float = 600.0
    startup: float = STARTUP_SECONDS
    is_trunk: bool = False


@dataclass(slots=True)
class Result:
    """What became of a worker.

    Attributes:
        task: its task.
        sites, ends, problems: what it reported.
        acted: tests in which its mutant did something; the empty one stands for before any test.
        reached: places of the program text by test, likewise.
        seen: what a recording saw of the program text.
        not_instrumented: files whose mutants cannot run, with the reason.
        in_mutated_call: whether it was in the midst of a mutated call when it was last heard of.
        held: tokens that it and its branches held when it was last heard of.
        running: test that was under way when it ended, or None.
        end: its orderly end; None if there was none.
        exit_code: its exit code, negative for a signal.
        overdue: which wall-clock limit it exceeded, in words, or None.
        wall: seconds from its start to its end.
        log: the last lines it printed.
    """

    task: Task
    sites: list[SiteSeen] = field(default_factory=list)
    ends: list[TestEnd] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    acted: list[str] = field(default_factory=list)
    reached: dict[str, tuple[int, ...]] = field(default_factory=dict)
    seen: TextsSeen | None = None
    not_instrumented: dict[str, str] = field(default_factory=dict)
    in_mutated_call: bool = False
    held: int = 0
    running: str | None = None
    end: SessionEnd | None = None
    exit_code: int = 0
    overdue: str | None = None
    wall: float = 0.0
    log: str = ""

    def take(self, line: Line) -> None:
        """Sort in one report line."""
        match line:
            case SiteSeen():
                self.sites.append(line)
            case TestStart():
                self.running = line.test
            case Acted() if line.mutant is None:
                self.acted.append(line.test)
            case PlacesReached():
                self.reached[line.test] = line.places
            case TextsSeen():
                self.seen = line
            case NotInstrumented():
                self.not_instrumented[line.file] = line.reason
            case MutatedCall() if line.mutant is None:
                self.in_mutated_call = line.began
            case TokensHeld():
                self.held = line.held
            case TestEnd():
                self.ends.append(line)
                self.running = None
            case Problem():
                self.problems.append(line)
            case SessionEnd():
                self.end = line


class Workers:
    """Runs tasks in up to ``jobs`` worker processes at a time.

    Args:
        root: the project's root; workers start there.
        arguments: pytest arguments of the project.
        jobs: how many run side by side.

    Use as a context manager: leaving it ends whatever still runs and removes temporary files.
    """

    def __init__(self, root: Path, arguments: Iterable[str], jobs: int) -> None:
        self._root = root
        self._arguments = tuple(arguments)
        self._jobs = max(1, jobs)
        self._selector = selectors.DefaultSelector()
        self._workers: list[_Worker] = []
        self.pool = TokenPool(self._jobs)
        home = root / ".mutabot"
        try:
            home.mkdir(exist_ok=True)
            ignore = home / ".gitignore"
            if not ignore.exists():
                ignore.write_text("*\n", encoding="utf-8")
            self._folder = tempfile.TemporaryDirectory(prefix="work-", dir=home)
        except OSError as error:
            raise JournalError(f"cannot write to {home}: {error.strerror}", path=str(home)) from error

    def __enter__(self) -> Workers:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        for worker in self._workers:
            worker.kill()
            worker.close(self._selector)
        self._workers.clear()
        self._selector.close()
        self.pool.close()
        self._folder.cleanup()

    def run(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Results in the order in which they end. Tasks are taken from the iterable as places free up."""
        for event in self.events(tasks):
            if isinstance(event, Result):
                yield event

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Line]]:
        """Report lines as they come, with their task, and results in the order in which they end."""
        waiting = iter(tasks)
        next_task = next(waiting, None)
        while True:
            while next_task is not None and self._has_place(next_task):
                self._start(next_task)
                next_task = next(waiting, None)
            if not self._workers:
                return
            yield from self._wait(for_token=next_task is not None and next_task.is_trunk)

    def _has_place(self, task: Task) -> bool:
        if len(self._workers) >= self._jobs:
            return False
        if not task.is_trunk:
            return True
        if not self._workers:
            self.pool.refill()  # nobody is left who could hold one
        return self.pool.take()

    def _start(self, task: Task) -> None:
        descriptors = self.pool.descriptors if task.is_trunk else ()
        worker = _Worker(task, self._root, self._arguments, Path(self._folder.name), descriptors)
        worker.watch(self._selector)
        self._workers.append(worker)

    def _wait(self, *, for_token: bool) -> Iterator[Result | tuple[Task, Line]]:
        timeout = max(0.0, min(worker.until for worker in self._workers) - time.monotonic())
        if for_token and len(self._workers) < self._jobs:
            self._selector.register(self.pool.reading, selectors.EVENT_READ, None)
        ready = self._selector.select(timeout)
        if self.pool.reading in self._selector.get_map():
            self._selector.unregister(self.pool.reading)
        for key, _ in ready:
            worker: _Worker | None = key.data
            if worker is None:
                continue
            if key.fd == worker.pipe:
                for line in worker.read():
                    yield worker.task, line
            else:
                worker.exited = True
        now = time.monotonic()
        for worker in list(self._workers):
            if now >= worker.until and not worker.exited:
                worker.expire()
            if worker.exited:
                yield from self._finish(worker)

    def _finish(self, worker: _Worker) -> Iterator[Result | tuple[Task, Line]]:
        self._workers.remove(worker)
        lines, result = worker.finish(self._selector)
        for line in lines:
            yield worker.task, line
        if worker.task.is_trunk:
            self.pool.give_back(result.held)  # what a trunk that died had not given back itself
        yield result


class _Worker:
    """One running worker process."""

    def __init__(
        self, task: Task, root: Path, arguments: tuple[str, ...], folder: Path, descriptors: tuple[int, ...]
    ) -> None:
        self.task = task
        self.result = Result(task, held=1 if task.is_trunk else 0)
        self.exited = False
        self._buffer = b""
        self._started = time.monotonic()
        self.until = self._started + task.startup
        self._home = Path(tempfile.mkdtemp(dir=folder))
        job_file = self._home / "job.json"
        job_file.write_text(json.dumps(to_data(task.job)), encoding="utf-8")
        self._log = self._home / "log.txt"
        self.pipe, writing = os.pipe()
        os.set_blocking(self.pipe, False)
        try:
            with self._log.open("wb") as log:
                self._process = subprocess.Popen(
                    command(arguments, self._home),
                    cwd=root,
                    env=environment(job_file, writing),
                    stdin=subprocess.DEVNULL,
                    stdout=log,
                    stderr=subprocess.STDOUT,
                    pass_fds=(writing, *descriptors),
                    start_new_session=True,
                )
        finally:
            os.close(writing)
        self._pidfd = os.pidfd_open(self._process.pid)

    def watch(self, selector: selectors.BaseSelector) -> None:
        selector.register(self.pipe, selectors.EVENT_READ, self)
        selector.register(self._pidfd, selectors.EVENT_READ, self)

    def read(self) -> list[Line]:
        """Take what the pipe holds."""
        taken: list[Line] = []
        while True:
            try:
                data = os.read(self.pipe, 1 << 16)
            except BlockingIOError:
                return taken
            if not data:
                return taken
            *texts, self._buffer = (self._buffer + data).split(b"\n")
            taken.extend(line for text in texts if (line := self._take(text)) is not None)

    def _take(self, text: bytes) -> Line | None:
        if not text:
            return None
        try:
            line = line_from_data(json.loads(text))
        except (ValueError, KeyError, TypeError):
            return None  # cut off: its writer was killed while it wrote
        self.result.take(line)
        if isinstance(line, TestEnd):
            self.until = time.monotonic() + self.task.startup
        elif isinstance(line, TestStart) or self.task.is_trunk:
            running = self.result.running or ""
            self.until = time.monotonic() + self.task.deadlines.get(running, self.task.deadline)
        return line

    def expire(self) -> None:
        """The wall clock ran out: end the process group."""
        if self.result.running is not None:
            limit = self.task.deadlines.get(self.result.running, self.task.deadline)
            self.result.overdue = f"no end after {limit:.0f} s of wall clock"
        else:
            self.result.overdue = f"no test begun or finished within {self.task.startup:.0f} s"
        self.kill()
        self._process.wait()
        self.exited = True

    def kill(self) -> None:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)

    def finish(self, selector: selectors.BaseSelector) -> tuple[list[Line], Result]:
        """Collect the rest of a process that has ended: its last lines, and what became of it."""
        self.result.exit_code = self._process.wait()
        self.kill()  # whatever it left behind
        lines = self.read()
        self.result.wall = time.monotonic() - self._started
        self.result.log = self._log.read_bytes()[-4000:].decode("utf-8", "replace")
        self.close(selector)
        return lines, self.result

    def close(self, selector: selectors.BaseSelector) -> None:
        for descriptor in (self.pipe, self._pidfd):
            selector.unregister(descriptor)
            os.close(descriptor)
        self._process.wait()
        for file in sorted(self._home.rglob("*"), reverse=True):
            file.rmdir() if file.is_dir() else file.unlink()
        self._home.rmdir()


def command(arguments: tuple[str, ...], home: Path) -> list[str]:
    """The command line of a worker."""
    off = [word for module, words in _SWITCHED_OFF.items() if find_spec(module) for word in words]
    own = ["--maxfail=0", "--tb=short", "-o", f"cache_dir={home / 'cache'}"]
    return [sys.executable, "-m", "pytest", "-p", "mutabot", *off, *arguments, *own]


def environment(job_file: Path, pipe: int) -> dict[str, str]:
    """The environment of a worker.

    Nothing is written beside the user's sources, and hashing and numeric libraries behave the same in
    every worker. Settings of the user's own take precedence.
    """
    settings = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return {
        "PYTHONHASHSEED": "0",
        **settings,
        **os.environ,
        "PYTHONDONTWRITEBYTECODE": "1",
        JOB_VARIABLE: str(job_file),
        PIPE_VARIABLE: str(pipe),
    }
