"""The way to the campaign, for every process that the tests start: its environment, and the file ``wake``.

The environment goes along also where a process is given one of its own. It leads to the start-up module, and
that reads in ``wake`` what is of interest. Which test is running is known to all processes below it at no
cost; and it is noted which are started out of sight, how each ended, and by whose signals.

Programs that are started to end others: nobody can know from outside whom they end.

What the test process notes of the processes that it starts: which are out of sight, how each ended, and by
whose signals.
"""

from __future__ import annotations

import json
import mmap
import os
import re
import struct
import subprocess
import sys
from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from typing import Any

from mutabot.model.event_file import ANYBODY, NOW, TESTS, VARIABLE, WAKE

#: the folder of the start-up module
STARTUP = os.path.join(os.path.dirname(os.path.abspath(__file__)), "startup")
#: which argument of ``fork_exec`` is the environment, <Lib/subprocess.py>
_ENVIRONMENT = 5
_folder = ""


def carry(folder: str) -> None:
    """Let every process that is started from now on find its way to the processes of this folder."""
    global _folder  # noqa: PLW0603  # a copy of a fork server has a folder of its own
    os.environ["PYTHONPATH"] = with_startup(os.environ.get("PYTHONPATH"))
    os.environ[VARIABLE] = folder
    if not _folder:
        _patch()
    _folder = folder


def with_startup(path: str | None) -> str:
    """A ``PYTHONPATH`` with the start-up module first."""
    others = [entry for entry in (path or "").split(os.pathsep) if entry and entry != STARTUP]
    return os.pathsep.join([STARTUP, *others])


def completed(environment: Sequence[bytes]) -> list[bytes]:
    """An environment, as ``NAME=value`` each, with the way in it."""
    given = dict(entry.partition(b"=")[::2] for entry in environment)
    path = given.get(b"PYTHONPATH")
    given[b"PYTHONPATH"] = os.fsencode(with_startup(os.fsdecode(path) if path is not None else None))
    given[os.fsencode(VARIABLE)] = os.fsencode(_folder)
    return [name + b"=" + value for name, value in given.items()]


def _patch() -> None:
    """Where ``subprocess`` is not there yet, it will take the function from the module that it is made of."""
    module: Any = sys.modules.get("subprocess")
    name = "_fork_exec" if module is not None else "fork_exec"
    if module is None:  # where nothing is started it is of no use
        module = import_module("_posixsubprocess")
    start = getattr(module, name)

    def fork_exec(*arguments: Any) -> Any:
        environment = arguments[_ENVIRONMENT]
        if environment is not None:
            arguments = (*arguments[:_ENVIRONMENT], completed(environment), *arguments[_ENVIRONMENT + 1 :])
        return start(*arguments)

    setattr(module, name, fork_exec)


def write_wake(folder: str, join: str, names: Iterable[str], files: Iterable[str]) -> None:
    """Say what is of interest.

    Args:
        folder: the folder of the campaign's processes.
        join: the module whose ``join`` is called, with this folder, in a process of interest.
        names: top-level names of modules.
        files: real paths of files and folders.
    """
    from mutabot.extensions import packages  # noqa: PLC0415  # of no use to processes below the tests

    own = sorted({*packages(), "wrapt"})
    lines = [
        f"join {join}",
        *(f"path {place}" for place in _folders_of(own)),
        *(f"own {name}" for name in own),
        *(f"name {name}" for name in sorted(set(names))),
        *(f"file {file}" for file in files),
    ]
    with open(os.path.join(folder, WAKE), "w", encoding="utf-8", errors="surrogateescape") as file:
        file.write("".join(f"{line}\n" for line in lines))


def _folders_of(names: Iterable[str]) -> list[str]:
    """Where another interpreter finds what the inside needs."""
    from importlib.util import find_spec  # noqa: PLC0415  # as above

    places: list[str] = []
    for spec in map(find_spec, names):
        if spec is not None:
            places += spec.submodule_search_locations or filter(os.path.isabs, [spec.origin or ""])
    return list(dict.fromkeys(map(os.path.dirname, places)))


_NUMBER = struct.Struct("=q")


class Now:
    """The number of the running test, in memory that processes share.

    Args:
        folder: the folder of the campaign's processes.
        is_host: whether this is the test process, which says so.
    """

    def __init__(self, folder: str, *, is_host: bool = False) -> None:
        self._folder = folder
        self._names = [""]
        name = os.path.join(folder, NOW)
        if is_host:
            with open(name, "wb") as file:
                file.write(bytes(mmap.PAGESIZE))
        descriptor = os.open(name, os.O_RDWR | os.O_CLOEXEC)
        try:
            self._memory = mmap.mmap(descriptor, mmap.PAGESIZE)
        finally:
            os.close(descriptor)

    @property
    def number(self) -> int:
        """The running test's; the last one's between tests, 0 before any."""
        number: int = _NUMBER.unpack_from(self._memory)[0]
        return number

    def note_unwritten(self) -> None:
        """This process could not: that takes no room on any disk."""
        _NUMBER.pack_into(self._memory, _NUMBER.size, 1)

    def begin(self, test: str) -> int:
        """In the test process: a test begins. Returns its number."""
        with open(os.path.join(self._folder, TESTS), "a", encoding="utf-8") as file:
            file.write(json.dumps(test) + "\n")
        _NUMBER.pack_into(self._memory, 0, self.number + 1)
        return self.number

    def name_of(self, number: int) -> str:
        """The node id of a test."""
        if number >= len(self._names):
            with open(os.path.join(self._folder, TESTS), encoding="utf-8") as file:
                self._names = ["", *(json.loads(line) for line in file)]
        return self._names[number]


#: with ``timeout`` and the launchers of ROS, which end what they have started
_KILLERS = {
    "kill",
    "pkill",
    "killall",
    "skill",
    "fuser",
    "timeout",
    "rosnode",
    "roslaunch",
    "rostest",
    "ros2",
}
#: what runs a command that it is given
_RUNNERS = {"sh", "bash", "dash", "zsh", "ksh", "env", "sudo", "nice", "nohup", "setsid", "xargs"}
_KILLER_IN_TEXT = re.compile(rf"(?<![\w.-])(?:{'|'.join(sorted(_KILLERS))})(?![\w.-])")


def starts_a_killer(event: str, arguments: tuple[Any, ...]) -> bool:
    """Whether an audit event is the start of a program that may end others, itself or by a shell."""
    if event == "os.system":
        return _mentions_killer(arguments[:1])
    if event in ("subprocess.Popen", "os.posix_spawn", "os.exec"):
        command = arguments[1]
        return _is_killer([command] if isinstance(command, str | bytes | os.PathLike) else list(command))
    return False


def _is_killer(command: Sequence[Any]) -> bool:
    name = os.path.basename(os.fsdecode(command[0])) if command else ""
    return name in _KILLERS or (name in _RUNNERS and _mentions_killer(command[1:]))


def _mentions_killer(words: Sequence[Any]) -> bool:
    return any(_KILLER_IN_TEXT.search(os.fsdecode(word)) for word in words)


#: options of Python by which it leaves out the environment, or what is loaded at its start
_APART = {"-I": "the option -I", "-E": "the option -E", "-S": "the option -S"}


class Exits:
    """What the test process knows of the ends of its children.

    Attributes:
        codes: exit codes by process, negative for a signal.
        signalled: processes, and groups (negative), that the tests sent a signal to; ``ANYBODY`` if they
            started what does so.
    """

    def __init__(self) -> None:
        self.codes: dict[int, int] = {}
        self.signalled: set[int] = set()

    def watch(self) -> None:
        """Look from now on; it cannot be taken back."""
        self._watch_waiting()
        self._watch_popen()
        sys.addaudithook(self._hear)

    def _watch_waiting(self) -> None:
        wait = os.waitpid

        def waitpid(pid: int, options: int, /) -> tuple[int, int]:
            found, status = wait(pid, options)
            if found:
                self.codes[found] = os.waitstatus_to_exitcode(status)
            return found, status

        os.waitpid = waitpid

    def _watch_popen(self) -> None:
        kind: Any = subprocess.Popen
        handle = kind._handle_exitstatus

        def handled(popen: Any, status: int, *more: Any) -> None:
            handle(popen, status, *more)
            if popen.returncode is not None:
                self.codes[popen.pid] = popen.returncode

        kind._handle_exitstatus = handled

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event == "os.kill":
            self.signalled.add(arguments[0])
        elif event == "os.killpg":
            self.signalled.add(-arguments[0])
        elif starts_a_killer(event, arguments):
            self.signalled.add(ANYBODY)


def watch_unseen(tell: Callable[[str, str], None]) -> None:
    """Look from now on which processes are started that do not find their way to the campaign.

    ``tell`` is told the command and why nothing in it is seen. It cannot be taken back.
    """

    def hear(event: str, arguments: tuple[Any, ...]) -> None:
        if event == "subprocess.Popen":
            words = _words(*arguments[:2])
            why = _why(words)
            if why is not None:
                tell(" ".join(words[:3]), why)

    sys.addaudithook(hear)


def _words(executable: Any, command: Any) -> list[str]:
    try:
        given = [command] if isinstance(command, str | bytes | os.PathLike) else list(command)
        words = [os.fsdecode(word) for word in given]
        return [os.fsdecode(executable), *words[1:]] if executable is not None else words
    except TypeError:  # it will not start either
        return []


def _why(words: Sequence[str]) -> str | None:
    if not words or not os.path.basename(words[0]).startswith("python"):
        return None
    for word in words[1:]:
        if not word.startswith("-"):
            break
        if word in _APART:
            return f"{_APART[word]} keeps it apart"
    return None
