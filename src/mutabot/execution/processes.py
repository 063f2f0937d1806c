"""Start processes that run jobs: fresh ones, and copies of a fork server that has collected the tests.

A process has a folder, a command line, an environment and an end, and it reports events. As many open files
as a campaign needs may be open at a time, or it is refused before anything runs.
"""

from __future__ import annotations

import compileall
import contextlib
import errno
import os
import resource
import secrets
import select
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from dataclasses import field, replace
from pathlib import Path
from shutil import disk_usage

from mutabot.errors import UsageError
from mutabot.execution.cleanup import remove_folder
from mutabot.execution.interruption import interruptible
from mutabot.frozen import frozen
from mutabot.model.event_file import FOLDER, FORKS, SESSION, SUFFIX, EventReader
from mutabot.model.events import Event, ForkEnded, Serving
from mutabot.model.files import open_file, read_file
from mutabot.model.fold import Children, acted_in, fold_fork
from mutabot.model.job import JOB_VARIABLE, PIPE_VARIABLE, STOP, Job, job_file, write_job
from mutabot.model.supervisor import FILE as SUPERVISOR
from mutabot.model.supervisor import LEFT

#: bytes that are read of what a process printed, and of the list of what it left running
_LOG_BYTES, _LEFT_BYTES = 4000, 1 << 20
#: seconds that a supervisor may take to end all it looks after
_PATIENCE = 15.0
#: bytes that must be free on the disk for a process to print what it prints
_ROOM = 1 << 14


@frozen
class Home:
    """The folder of a process: its job, its output, and pytest's cache.

    Attributes:
        folder: the folder.
        key: of the seals on what the process reports.
    """

    folder: Path
    key: str = field(default_factory=lambda: secrets.token_hex(16), repr=False)

    @classmethod
    def make(cls, parent: Path, job: Job) -> Home:
        """Make a folder in ``parent`` with the job in it; ``parent`` is made again if it is gone."""
        parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        home = cls(Path(tempfile.mkdtemp(dir=parent)))
        home.processes.mkdir()
        write_job(home.folder, replace(job, key=home.key))
        Path(home.events(SESSION)).touch(mode=0o600)
        return home

    @property
    def job_file(self) -> str:
        """The path of the job's file."""
        return job_file(self.folder)

    @property
    def log_file(self) -> Path:
        """The path of the file with the process's output."""
        return self.folder / "log.txt"

    @property
    def processes(self) -> Path:
        """The folder by which processes below it find it."""
        return self.folder / FOLDER

    def events(self, name: str) -> str:
        """Return the path of the event file of a process."""
        return f"{self.processes}/{name}{SUFFIX}"

    @property
    def has_forks(self) -> bool:
        """Whether the process has forks whose end it has not reported."""
        return any(self.processes.glob(f"{SESSION}.*{SUFFIX}"))

    def stop_forks(self) -> None:
        """Make the process end its forks and start no more."""
        with contextlib.suppress(OSError):  # the folder was deleted
            (self.folder / STOP).touch()

    def log_text(self) -> str:
        """Return the end of the process's output."""
        try:
            descriptor = open_file(self.log_file, os.O_RDONLY)
        except OSError:
            return ""
        with os.fdopen(descriptor, "rb") as file:
            file.seek(max(0, os.fstat(descriptor).st_size - _LOG_BYTES))
            return file.read(_LOG_BYTES).decode("utf-8", "replace")

    @property
    def is_whole(self) -> bool:
        """Whether the folder still exists, which only the controller may remove."""
        return Path(self.job_file).is_file() if os.access(self.folder, os.X_OK) else False

    def remove(self) -> None:
        """Remove the folder with its content."""
        remove_folder(self.folder)


def refuse_full_disk(folder: Path) -> None:
    """Raise OSError if a process that worked in ``folder`` may have died because the disk is full."""
    try:
        is_full = disk_usage(folder).free < _ROOM
    except FileNotFoundError:  # it was deleted
        return
    if is_full:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(folder))


class Spawned:
    """A fresh process, with a supervisor above it that ends everything it starts.

    Attributes:
        pid: the supervisor's number.
        pidfd: becomes readable when it ends.
        startup: seconds spent on it before it began; none.
    """

    startup = 0.0

    def __init__(
        self,
        root: Path,
        arguments: Iterable[str],
        home: Home,
        writing: int,
        descriptors: tuple[int, ...] = (),
    ) -> None:
        self._left = home.folder / LEFT
        supervisor = [sys.executable, "-I", "-S", SUPERVISOR, str(os.getpid())]
        with home.log_file.open("wb") as log:
            self._process = subprocess.Popen(
                [*supervisor, *command(arguments, home.folder)],
                cwd=root,
                env=environment(home.job_file, writing),
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                pass_fds=(writing, *descriptors),
                start_new_session=True,
            )
        self.pid = self._process.pid
        self.pidfd = os.pidfd_open(self.pid)

    @property
    def exit_code(self) -> int | None:
        """Its exit code, negative for a signal; None while it runs."""
        return self._process.poll()

    @property
    def left(self) -> list[str] | None:
        """What it had left running when it ended; None if the supervisor could not end that."""
        try:
            return read_file(self._left, _LEFT_BYTES).decode("utf-8", "replace").splitlines()
        except OSError:
            return None

    def kill(self) -> None:
        """End it and everything it has started, without waiting for that."""
        self._process.terminate()

    def end(self) -> int:
        """End it with all that it left behind, if it still runs. Return its exit code."""
        self.kill()
        try:
            return self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:  # the supervisor was stopped
            self._process.kill()
            return self._process.wait()

    def release(self) -> None:
        """Release all resources that are held for it."""
        os.close(self.pidfd)


def kill_group(pid: int) -> None:
    """End all processes of a group."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)


class EventStream:
    """The events of a test process, and those of its forks once they have ended.

    The report of a fork counts as a whole or not at all: where something is missing, or is none of ours, its
    mutants have not been run.

    Args:
        home: that of the test process.

    Attributes:
        bell: can be read when there is something new. What is in it means nothing.
        writing: with which the test process says so.
    """

    def __init__(self, home: Home) -> None:
        self.bell, self.writing = os.pipe()
        self._home = home
        self._reader = EventReader(home.events(SESSION), home.key)
        os.set_blocking(self.bell, False)

    def read(self, *, is_last: bool = False) -> list[Event]:
        """Return the events written so far; ``is_last`` means that all processes have ended."""
        return self._with_forks(SESSION, self.own(is_last=is_last))

    def own(self, *, is_last: bool = False) -> list[Event]:
        """Return the events of the process itself, with the ends of its forks."""
        with contextlib.suppress(BlockingIOError):
            os.read(self.bell, 1 << 21)  # more than what a pipe holds
        return self._reader.read(is_last=is_last)

    def close(self) -> None:
        """Close the files of events."""
        os.close(self.bell)
        os.close(self.writing)

    def _with_forks(self, name: str, events: Iterable[Event]) -> list[Event]:
        """Return the events of a process, with those of its forks inserted at their ends."""
        found: list[Event] = []
        for event in events:
            if isinstance(event, ForkEnded):
                found += self._of_fork(f"{name}.{event.fork}", event)
            else:
                found.append(event)
        return found

    def _of_fork(self, name: str, ended: ForkEnded) -> list[Event]:
        """Return the events of a fork that has ended; none if they are unreliable."""
        folder = Path(self._home.folder, FORKS, name)
        file = folder / FOLDER / (name + SUFFIX)
        if not file.exists():  # it had no folder of its own yet
            file = Path(self._home.events(name))
        reader = EventReader(str(file), self._home.key)
        events = reader.read(is_last=True)
        below = Children(str(folder), self._home.key)
        if ended.died is not None and (folder / FOLDER).is_dir():  # else it has reported them itself
            below.read()
        if reader.damage is not None or below.doubt is not None:
            return []
        file.unlink(missing_ok=True)
        acted = acted_in(below.records.values())
        return self._with_forks(name, fold_fork(events, ended.exit_code, ended.died, acted))


#: seconds that a server may take to answer, and to end, once its tests are collected
_ANSWER = 30.0
#: seconds between two looks whether a run is still wanted
LOOKS = 0.2
#: seconds for which one system call may wait: the limits of a suite with many tests can be more than it takes
LONGEST = 3600.0


class Copy:
    """A copy of a fork server, running a job. Like ``Spawned``, but the server waits for it."""

    pidfd = None
    #: only the server's supervisor looks after what it leaves
    left: list[str] | None = None

    def __init__(self, pid: int, server: ForkServerProcess) -> None:
        self.pid, self._server = pid, server
        self.startup = server.startup

    @property
    def exit_code(self) -> int | None:
        """Its exit code, negative for a signal; None while it runs."""
        return self._server.exit_code_of(self.pid)

    def kill(self) -> None:
        """End it and everything it has started."""
        if self.exit_code is None:
            kill_group(self.pid)
            with contextlib.suppress(ProcessLookupError):  # it may not lead its group yet
                os.kill(self.pid, signal.SIGKILL)

    def end(self) -> int:
        """End it if it has not ended yet. Return its exit code."""
        self.kill()
        return self._server.wait_for(self.pid)

    def release(self) -> None:
        """Do nothing, as no resource is held."""


class ForkServerProcess:
    """A process that has collected the tests, and is copied for each job.

    Args:
        job: a job of the kind that it is to serve.
        root, arguments: as for every worker.
        folder: where its home is made.

    Attributes:
        events: what it reports.
        process: the server.
        startup: seconds it took to start.
    """

    def __init__(self, job: Job, root: Path, arguments: Iterable[str], folder: Path) -> None:
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
            self.process = Spawned(root, arguments, self._home, self.events.writing, (theirs.fileno(),))

    def serves(self, job: Job) -> bool:
        """Return whether a copy can do this job: all that matters before the first test is the same."""
        return _template(job) == self._template

    @property
    def is_idle(self) -> bool:
        """Whether none of its copies is at work."""
        return None not in self._codes.values()

    def wait_until_ready(self, seconds: float, look: Callable[[], None] | None = None) -> str | None:
        """Wait until the tests are collected. Return why it cannot serve, or None if it can.

        ``look``: called several times a second meanwhile; what it raises ends the wait.
        """

        def is_ready() -> bool:
            if look is not None:
                look()
            return self.serving is not None

        with interruptible():
            self._listen_until(is_ready, seconds, LOOKS if look is not None else LONGEST)
        self.startup = time.monotonic() - self._started
        if self.serving is None:
            return "the process that was to collect the tests did not get there"
        return self.serving.reason

    def copy(self, home: Home, writing: int) -> Copy | None:
        """Return a new copy that runs the job in ``home``; None if the server is gone."""
        self._copied = None
        try:
            socket.send_fds(self._jobs, [os.fsencode(home.folder)], [writing])
        except OSError:
            return None
        self._listen_until(lambda: self._copied is not None, _ANSWER)
        return Copy(self._copied, self) if self._copied is not None else None

    def listen(self) -> None:
        """Read the reports of the server."""
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
        """Return the exit code of a copy; None while it runs. Copies die with the server."""
        code = self._codes[pid]
        if code is None and self.process.exit_code is not None:
            self.listen()
            code = self._codes[pid]
            return -signal.SIGKILL if code is None else code
        return code

    def wait_for(self, pid: int) -> int:
        """Return the exit code of a copy that is about to end."""
        self._listen_until(lambda: self._codes[pid] is not None, _ANSWER)
        if self._codes[pid] is None:  # it cannot be relied on any more
            self.process.kill()
        code = self.exit_code_of(pid)
        return -signal.SIGKILL if code is None else code

    def close(self) -> list[str]:
        """End it and all copies. Return what these had left running."""
        self._jobs.close()
        self._listen_until(lambda: False, _ANSWER if self.serving is not None else 0.0)
        self.process.end()
        left = self.process.left or []  # it is reported in the home
        self.process.release()
        self.events.close()
        self._home.remove()
        return left

    def _listen_until(self, done: Callable[[], bool], seconds: float, period: float = LONGEST) -> None:
        """Read reports until ``done``, asked once a ``period``, the server's end, or the time limit."""
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
    """Return what jobs must have in common to run as copies of one fork server."""
    return replace(
        job,
        round=0,
        tests=None,
        mutant=None,
        record=False,
        stop_at_kill=False,
        simulated={},
        spare=0.0,
        moments={},
        inspect=False,
        forking=None,
        active={},
    )


def command(arguments: Iterable[str], home: Path) -> list[str]:
    """Return the command line of a worker."""
    # the native traceback is the one that pytest need not parse any source for: that took a killed mutant
    # longer than all else together
    own = ["--maxfail=0", "--tb=native", "-o", f"cache_dir={home / 'cache'}"]
    return [sys.executable, "-m", "pytest", "-p", "mutabot", *arguments, *own]


def environment(job_file: str, pipe: int) -> dict[str, str]:
    """Return the environment of a worker."""
    return {**usual_environment(), JOB_VARIABLE: job_file, PIPE_VARIABLE: str(pipe)}


#: what processes of the tests import of us
_OF_PROCESSES = ("evidence", "languages", "model", "operators", "runtime")


def compile_own_modules() -> None:
    """Compile the modules of mutabot that processes of the tests import, as those write no compiled files.

    Some installers and all editable installations leave that to the first import, which would be each
    process's.
    """
    ours = Path(__file__).parents[1]
    if not os.access(ours, os.W_OK):
        return
    compileall.compile_dir(ours, maxlevels=0, quiet=2)
    for part in _OF_PROCESSES:
        compileall.compile_dir(ours / part, quiet=2)


def usual_environment() -> dict[str, str]:
    """Return the environment variables that all workers have in common.

    Nothing is written beside the user's sources, and hashing and numeric libraries behave the same in
    every worker. Settings of the user's own take precedence.
    """
    settings = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return {
        "PYTHONHASHSEED": "0",
        **settings,
        **os.environ,
        "PYTHONDONTWRITEBYTECODE": "1",
    }


#: for Python, the journal and what is recorded; for pytest with its plug-ins, the program under test, a page
_ALWAYS = 256
#: for each of ``-j``: pipes, the process itself, and as much to begin it
_EACH = 16


def needed(jobs: int) -> int:
    """Return how many files a campaign may have open at once."""
    return _ALWAYS + _EACH * jobs


def provide(jobs: int) -> None:
    """Raise the limit of open files of this process and its children, if it is too low.

    Raises UsageError if the system does not allow that.
    """
    wanted = needed(jobs)
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft == resource.RLIM_INFINITY or soft >= wanted:
        return
    if hard == resource.RLIM_INFINITY or hard >= wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
        return
    fewer = (hard - _ALWAYS) // _EACH
    advice = f", or use -j {fewer}" if fewer > 0 else ""
    raise UsageError(
        f"-j {jobs} needs {wanted} open files at a time, but the system allows {hard} (RLIMIT_NOFILE): raise "
        f"that limit (`ulimit -Hn {wanted}` as root){advice}"
    )
