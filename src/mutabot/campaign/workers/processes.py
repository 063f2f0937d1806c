"""What a worker process needs from the system: a folder, a command line, an environment, a pipe, an end."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from shutil import disk_usage
from types import TracebackType
from typing import Any

from mutabot.border.job import JOB_VARIABLE, PIPE_VARIABLE, Job, job_file, write_job
from mutabot.border.keeper import FILE as KEEPER
from mutabot.border.keeper import LEFT
from mutabot.border.lines import Line, line_from_data
from mutabot.border.processes import FOLDER
from mutabot.border.starter import Starter

_LOG_BYTES = 4000
#: seconds that a keeper may take to end all it looks after
_PATIENCE = 15.0
#: bytes that must be free on the disk for a process to print what it prints
_ROOM = 1 << 14


@dataclass(frozen=True, slots=True)
class Home:
    """A process's own folder: its job, what it prints, pytest's cache."""

    folder: Path

    @classmethod
    def make(cls, parent: Path, job: Job) -> Home:
        """A new folder in ``parent``, with the job in it."""
        home = cls(Path(tempfile.mkdtemp(dir=parent)))
        write_job(home.folder, job)
        return home

    @property
    def job_file(self) -> Path:
        """Where the job is."""
        return job_file(self.folder)

    @property
    def log_file(self) -> Path:
        """Where the process's output goes."""
        return self.folder / "log.txt"

    @property
    def processes(self) -> Path:
        """The folder that processes below it know it by."""
        return self.folder / FOLDER

    def log_text(self) -> str:
        """The last of what the process printed."""
        if not self.log_file.exists():
            return ""
        return self.log_file.read_bytes()[-_LOG_BYTES:].decode("utf-8", "replace")

    def remove(self) -> None:
        """Remove it with all that is in it."""
        shutil.rmtree(self.folder, onerror=_let_in)


def _let_in(
    function: Any, path: str, error: tuple[type[BaseException], BaseException, TracebackType]
) -> None:
    """A folder that its owner may not enter, as the layers of private files have them: enter and go on."""
    if not isinstance(error[1], PermissionError):
        raise error[1]
    Path(path).parent.chmod(0o700)
    if Path(path).is_dir():
        Path(path).chmod(0o700)
    shutil.rmtree(path, onerror=None) if Path(path).is_dir() else Path(path).unlink()


def refuse_full_disk(folder: Path) -> None:
    """Raises OSError if a process that worked in ``folder`` may have died because there is no room left."""
    if disk_usage(folder).free < _ROOM:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(folder))


class Spawned:
    """A fresh process, with a keeper above it that ends all it starts; ``starter``: what may begin it warm.

    Attributes:
        pid: the keeper's number.
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
        starter: Starter | None = None,
    ) -> None:
        self._left = home.folder / LEFT
        keeper = [sys.executable, "-I", "-S", KEEPER, str(os.getpid())]
        warm = starter.at_work(keeper) if starter is not None else contextlib.nullcontext()
        kept = keeper if starter is None else []
        with home.log_file.open("wb") as log, warm:
            self._process = subprocess.Popen(
                [*kept, *command(arguments, home.folder)],
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
    def tests(self) -> int:
        """The number of the process that runs the tests; the keeper's if there is none."""
        with contextlib.suppress(OSError, ValueError, IndexError):
            return int(Path(f"/proc/{self.pid}/task/{self.pid}/children").read_text("ascii").split()[0])
        return self.pid

    @property
    def left(self) -> list[str] | None:
        """What it had left running when it ended, and was ended; None if the keeper did not see to that."""
        try:
            return self._left.read_text("utf-8", "replace").splitlines()
        except OSError:
            return None

    def kill(self) -> None:
        """End it and all it has started, without waiting for that."""
        self._process.terminate()

    def end(self) -> int:
        """End it, and whatever it left behind, if it has not ended yet; returns its exit code."""
        self.kill()
        try:
            return self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:  # the keeper was stopped
            self._process.kill()
            return self._process.wait()

    def release(self) -> None:
        """Let go of what is held of it."""
        os.close(self.pidfd)


def kill_group(pid: int) -> None:
    """End all processes of a group."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)


class LineReader:
    """Report lines from the reading end of a pipe, which it sets not to block."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._buffer = b""
        os.set_blocking(descriptor, False)

    def read(self) -> list[Line]:
        """All lines that are there by now."""
        lines: list[Line] = []
        while True:
            try:
                data = os.read(self._descriptor, 1 << 16)
            except BlockingIOError:
                return lines
            if not data:
                return lines
            *texts, self._buffer = (self._buffer + data).split(b"\n")
            lines.extend(line for text in texts if (line := _line(text)) is not None)


def _line(text: bytes) -> Line | None:
    if not text:
        return None
    try:
        return line_from_data(json.loads(text))
    except (ValueError, KeyError, TypeError):
        return None  # cut off: its writer was killed while it wrote


def command(arguments: Iterable[str], home: Path) -> list[str]:
    """The command line of a worker."""
    # the native traceback is the one that pytest need not parse any source for: that took a killed mutant
    # longer than all else together
    own = ["--maxfail=0", "--tb=native", "-o", f"cache_dir={home / 'cache'}"]
    return [sys.executable, "-m", "pytest", "-p", "mutabot", *arguments, *own]


def environment(job_file: Path, pipe: int) -> dict[str, str]:
    """The environment of a worker."""
    return {**usual_environment(), JOB_VARIABLE: str(job_file), PIPE_VARIABLE: str(pipe)}


def usual_environment() -> dict[str, str]:
    """What the environments of all workers have in common.

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
