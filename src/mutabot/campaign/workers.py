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
from mutabot.model import Job, Problem, SessionEnd, SiteSeen, TestEnd, TestStart, to_data
from mutabot.model.job import JOB_VARIABLE, PIPE_VARIABLE, Acted, Line, line_from_data

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
    """

    key: Any
    job: Job
    deadlines: Mapping[str, float] = field(default_factory=dict)
    deadline: float = 600.0
    startup: float = STARTUP_SECONDS


@dataclass(slots=True)
class Result:
    """What became of a worker.

    Attributes:
        task: its task.
        sites, ends, problems: what it reported.
        acted: tests in which its mutant did something.
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
            case Acted():
                self.acted.append(line.test)
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
        self._folder.cleanup()

    def run(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Results in the order in which they end. Tasks are taken from the iterable as places free up."""
        waiting = iter(tasks)
        exhausted = False
        while True:
            while not exhausted and len(self._workers) < self._jobs:
                task = next(waiting, None)
                if task is None:
                    exhausted = True
                else:
                    self._start(task)
            if not self._workers:
                return
            yield from self._wait()

    def _start(self, task: Task) -> None:
        worker = _Worker(task, self._root, self._arguments, Path(self._folder.name))
        worker.watch(self._selector)
        self._workers.append(worker)

    def _wait(self) -> Iterator[Result]:
        now = time.monotonic()
        timeout = max(0.0, min(worker.until for worker in self._workers) - now)
        for key, _ in self._selector.select(timeout):
            worker: _Worker = key.data
            if key.fd == worker.pipe:
                worker.read()
            else:
                worker.exited = True
        now = time.monotonic()
        for worker in list(self._workers):
            if now >= worker.until and not worker.exited:
                worker.expire()
            if worker.exited:
                self._workers.remove(worker)
                yield worker.finish(self._selector)


class _Worker:
    """One running worker process."""

    def __init__(self, task: Task, root: Path, arguments: tuple[str, ...], folder: Path) -> None:
        self.task = task
        self.result = Result(task)
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
                    pass_fds=(writing,),
                    start_new_session=True,
                )
        finally:
            os.close(writing)
        self._pidfd = os.pidfd_open(self._process.pid)

    def watch(self, selector: selectors.BaseSelector) -> None:
        selector.register(self.pipe, selectors.EVENT_READ, self)
        selector.register(self._pidfd, selectors.EVENT_READ, self)

    def read(self) -> None:
        """Take what the pipe holds."""
        while True:
            try:
                data = os.read(self.pipe, 1 << 16)
            except BlockingIOError:
                return
            if not data:
                return
            *lines, self._buffer = (self._buffer + data).split(b"\n")
            for line in lines:
                self._take(line_from_data(json.loads(line)))

    def _take(self, line: Line) -> None:
        self.result.take(line)
        if isinstance(line, TestStart):
            self.until = time.monotonic() + self.task.deadlines.get(line.test, self.task.deadline)
        elif isinstance(line, TestEnd):
            self.until = time.monotonic() + self.task.startup

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

    def finish(self, selector: selectors.BaseSelector) -> Result:
        """Collect the rest of a process that has ended."""
        self.result.exit_code = self._process.wait()
        self.kill()  # whatever it left behind
        self.read()
        self.result.wall = time.monotonic() - self._started
        self.result.log = self._log.read_bytes()[-4000:].decode("utf-8", "replace")
        self.close(selector)
        return self.result

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
