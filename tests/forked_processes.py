"""Processes of campaigns as forks of an interpreter that has imported pytest: that took most of a campaign.

Where more than the command decides how a process begins, such as limits or variables that Python reads, it is
begun anew. The command line of mutabot in a process of its own begins all its processes anew.
"""

from __future__ import annotations

import json
import os
import re
import resource
import select
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from mutabot.execution import processes
from tests import forked_interpreter
from tests.forked_interpreter import MESSAGE_BYTES

#: of all variables those that Python or the system reads when a program is loaded
_AT_START = ("PYTHON", "LD_", "LC_", "LANG", "MALLOC_", "GLIBC_", "TZ")
#: what is imported ahead, or would be before everything else, must not be among what is to be found
_IMPORTED = re.compile("|".join([*sys.stdlib_module_names, "(site|user)customize", "_?pytest", "mutabot.*"]))
_LIMITS = [getattr(resource, name) for name in dir(resource) if name.startswith("RLIMIT_")]
_SIGNALS = signal.valid_signals() - {signal.SIGPIPE, signal.SIGXFSZ}  # Python ignores these itself
_DEADLINE = 30.0


class Forked:
    """A process begun as a fork, with what campaigns use of ``subprocess.Popen``."""

    def __init__(self, pid: int) -> None:
        self.pid = pid
        self.returncode: int | None = None

    def poll(self) -> int | None:
        if self.returncode is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            self.returncode = os.waitstatus_to_exitcode(status) if pid else None
        return self.returncode

    def wait(self, timeout: float) -> int:
        if self.poll() is None:
            pidfd = os.pidfd_open(self.pid)
            try:
                ended, _, _ = select.select([pidfd], [], [], timeout)
            finally:
                os.close(pidfd)
            if not ended:
                raise subprocess.TimeoutExpired([], timeout)
        return self.poll() or 0

    def terminate(self) -> None:
        if self.poll() is None:
            os.kill(self.pid, signal.SIGTERM)

    def kill(self) -> None:
        if self.poll() is None:
            os.kill(self.pid, signal.SIGKILL)


class Interpreter:
    """The process that is forked, started when it is first needed.

    Its forks are children of this process, as if that had begun them.
    """

    def __init__(self) -> None:
        self._owner, self._environment = os.getpid(), processes.usual_environment()
        self._began_with = _inherited(self._environment)
        self._requests: socket.socket | None = None
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> socket.socket:
        """Start it unless it runs. Return what takes requests."""
        if self._requests is not None:
            return self._requests
        self._requests, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        for end in (self._requests, theirs):
            end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, MESSAGE_BYTES)
        serve = f"runpy.run_path({forked_interpreter.__file__!r})['serve']"
        code = f"import runpy; {serve}({theirs.fileno()}, {self._owner})"
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-c", code],
                cwd="/",
                env=self._environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                pass_fds=(theirs.fileno(),),
                start_new_session=True,
            )
        return self._requests

    def begin(self, command: Sequence[str], **options: Any) -> Any:
        """Begin a process as ``subprocess.Popen`` does."""
        env = options["env"]
        if os.getpid() != self._owner or _inherited(env) != self._began_with:
            return subprocess.Popen(command, **options)
        requests, descriptors = self.start(), options["pass_fds"]
        request = json.dumps([command, os.fspath(options["cwd"]), env, descriptors]).encode()
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())  # else it reads a late answer
        try:
            socket.send_fds(requests, [request], [options["stdout"].fileno(), *descriptors])
            return Forked(int(requests.recv(64)))
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)

    def close(self) -> None:
        if self._requests is not None and self._process is not None:
            self._requests.close()
            self._process.wait(_DEADLINE)


def _inherited(env: Mapping[str, str]) -> tuple[Any, ...]:
    """What a new process gets from this one, beside its command, folder and open files."""
    os.umask(umask := os.umask(0o77))
    return (
        {
            name: value
            for name, value in env.items()
            if name.startswith(_AT_START) and not (name == "PYTHONPATH" and _is_only_more(value))
        },
        [resource.getrlimit(limit) for limit in _LIMITS],
        [number for number in _SIGNALS if signal.getsignal(number) is signal.SIG_IGN],
        signal.pthread_sigmask(signal.SIG_BLOCK, ()),
        (umask, os.nice(0), os.sched_getaffinity(0), os.getresuid()),
    )


def _is_only_more(places: str) -> bool:
    """Whether nothing in these folders stands in for what is imported ahead."""
    folders = [Path(place) for place in places.split(os.pathsep) if Path(place).is_dir()]
    return not any(_IMPORTED.fullmatch(file.stem) for folder in folders for file in folder.iterdir())


@contextmanager
def forked_processes() -> Iterator[Interpreter]:
    """Let campaigns in this process begin their processes so."""
    interpreter = Interpreter()
    popen = SimpleNamespace(**{**vars(subprocess), "Popen": interpreter.begin})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(processes, "subprocess", popen)
        yield interpreter
    interpreter.close()
