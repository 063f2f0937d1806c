"""Pass the campaign on to processes that the tests start, by the environment and the file ``wake``.

The environment goes along also where a process is given one of its own. It leads to the start-up module, and
that reads in ``wake`` what is of interest. All processes below a test know at no cost which test is running.
The test process notes which processes are started out of sight, how each ended, and by whose signals.

What is done is heard of by audit events: one hook hands each event to those that asked for it, since Python
calls every hook at every event, and ``sys._getframe`` is one, which notes in the program text ask for
at each call. A hook cannot be taken back.
"""

from __future__ import annotations

import mmap
import os
import struct
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial, wraps
from json import dumps, loads
from types import BuiltinFunctionType
from typing import Any

from mutabot.model.event_file import ANY_PROCESS, NOW, TESTS, VARIABLE, WAKE
from mutabot.model.events import OutOfReach
from mutabot.model.files import open_file, read_file
from mutabot.runtime.paths import BEGAN
from mutabot.runtime.processes.commands import STARTS, STARTUP, command_of, starts_a_killer, why_unseen
from mutabot.runtime.processes.named_files import files_named, imports_of

#: called with an event's name and its arguments
AuditHandler = Callable[[str, tuple[Any, ...]], None]
#: lists: a listener may add another one, which hears the same event
_listeners: dict[str, list[AuditHandler]] = {}
#: from the frame of a listener to that of what caused the event
FRAMES = 2


def listen(events: Iterable[str], handle: AuditHandler) -> None:
    """Call ``handle`` for each of these audit events from now on."""
    if not _listeners:
        sys.addaudithook(_on_audit_event)
    for event in events:
        _listeners.setdefault(event, []).append(handle)


def _on_audit_event(event: str, arguments: tuple[Any, ...]) -> None:
    for handle in _listeners.get(event, ()):
        handle(event, arguments)


#: which argument of ``fork_exec`` is the environment, <Lib/subprocess.py>
_ENVIRONMENT = 5
#: functions of ``os`` that start a program with an environment of its own, the third argument, ``env``;
#: the others that take one call ``execve``
_WITH_ENVIRONMENT = ("posix_spawn", "posix_spawnp", "execve")
#: which argument of ``fork_exec`` runs in the copy of the process before this becomes the program
_PREPARE = -2
#: what a copy of the process says before it prepares to become another program, and afterwards, with the
#: exception that ended it
PREPARES, PREPARED = "mutabot.prepares", "mutabot.prepared"
#: those of the copy of a process
FORKINGS = ("os.fork", "os.forkpty")
_folder = ""


def export_folder(folder: str) -> None:
    """Let every process that is started from now on find the folder of this campaign's processes."""
    global _folder  # noqa: PLW0603  # a copy of a fork server has a folder of its own
    if not _folder:
        _hook_starts()
    _folder = folder
    _set_variables()


def _set_variables() -> None:
    """Set the variables again in this process's environment, which tests may have changed."""
    environment = {"PYTHONPATH": with_startup(os.environ.get("PYTHONPATH")), VARIABLE: _folder}
    for name, value in environment.items():
        if os.environ.get(name) != value:
            os.environ[name] = value


def _hook_starts() -> None:
    """Complete the environment of every process at its start.

    ``subprocess`` and ``multiprocessing`` have their processes started by the same function.
    """
    import _posixsubprocess  # noqa: PLC0415  # of no use to a process that is not part of a campaign

    start = _posixsubprocess.fork_exec

    def fork_exec(*arguments: Any) -> Any:
        sys.audit("mutabot.fork_exec", None, arguments[0], None)
        environment = arguments[_ENVIRONMENT]
        if environment is not None:
            arguments = (*arguments[:_ENVIRONMENT], completed(environment), *arguments[_ENVIRONMENT + 1 :])
        prepare = arguments[_PREPARE]
        if callable(prepare) and not isinstance(prepare, BuiltinFunctionType):
            arguments = (*arguments[:_PREPARE], partial(_prepare, prepare), *arguments[_PREPARE + 1 :])
        return start(*arguments)

    _posixsubprocess.fork_exec = fork_exec
    for name in _WITH_ENVIRONMENT:
        setattr(os, name, _completing(getattr(os, name)))
    if "subprocess" in sys.modules:
        _replace(fork_exec)
    listen(STARTS, lambda event, arguments: _about_to_start(event, fork_exec))


def _prepare(prepare: Callable[[], Any]) -> None:
    """Run what ``preexec_fn`` gives: code that may be the program's, in a copy of this process."""
    sys.audit(PREPARES)
    try:
        prepare()
    except BaseException as error:
        sys.audit(PREPARED, error)
        raise
    sys.audit(PREPARED, None)


def _completing(start: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of ``os`` that completes the environment of the program it starts."""

    @wraps(start)
    def started(*arguments: Any, **options: Any) -> Any:
        if len(arguments) > 2:
            arguments = (*arguments[:2], _with_variables(arguments[2]), *arguments[3:])
        elif "env" in options:
            options["env"] = _with_variables(options["env"])
        return start(*arguments, **options)

    for known in (os.supports_fd, os.supports_dir_fd, os.supports_follow_symlinks):
        if start in known:
            known.add(started)
    return started


def _with_variables(environment: Any) -> Any:
    """Add variables to an environment that is a mapping; return any other value, which ``os`` refuses."""
    if not isinstance(environment, Mapping) or environment is os.environ:
        return environment  # ours has been completed already
    try:
        entries = [os.fsencode(name) + b"=" + os.fsencode(value) for name, value in environment.items()]
    except TypeError:
        return environment
    return dict(entry.partition(b"=")[::2] for entry in completed(entries))


def _about_to_start(event: str, fork_exec: Callable[..., Any]) -> None:
    _set_variables()
    if event == "subprocess.Popen":
        _replace(fork_exec)


def _replace(fork_exec: Callable[..., Any]) -> None:
    module: Any = sys.modules["subprocess"]
    module._fork_exec = fork_exec
    module._USE_POSIX_SPAWN = False  # it goes another way with ``close_fds=False``; this one does the same


def with_startup(path: str | None) -> str:
    """Return a ``PYTHONPATH`` with the start-up module first."""
    others = [entry for entry in (path or "").split(os.pathsep) if entry and entry != STARTUP]
    return os.pathsep.join([STARTUP, *others])


def completed(environment: Sequence[bytes]) -> list[bytes]:
    """Return an environment, as ``NAME=value`` each, with these variables."""
    given = dict(entry.partition(b"=")[::2] for entry in environment)
    path = given.get(b"PYTHONPATH")
    given[b"PYTHONPATH"] = os.fsencode(with_startup(os.fsdecode(path) if path is not None else None))
    given[os.fsencode(VARIABLE)] = os.fsencode(_folder)
    return [name + b"=" + value for name, value in given.items()]


def write_wake(
    folder: str,
    join: str,
    key: str,
    names: Iterable[str],
    files: Iterable[str],
    own: Iterable[str] = (),
) -> None:
    """Write the file that says which processes join the campaign, and how.

    Args:
        folder: the folder of the campaign's processes.
        join: the module whose ``join`` is called, with this folder, in a process of interest.
        key: of the seals on its events.
        names: top-level names of modules.
        files: real paths of files and folders.
        own: packages that are needed there beside those of ``extensions.packages``.
    """
    from mutabot.extensions import packages  # noqa: PLC0415  # of no use to processes below the tests

    own = sorted({*packages(), *own, "wrapt"})
    lines = [
        f"join {join}",
        f"key {key}",
        *(f"path {place}" for place in _folders_of(own)),
        *(f"own {name}" for name in own),
        *(f"name {name}" for name in sorted(set(names))),
        *(f"file {file}" for file in files),
    ]
    text = "".join(f"{line}\n" for line in lines)
    _write(os.path.join(folder, WAKE), text.encode("utf-8", "surrogateescape"), os.O_TRUNC)


def _write(path: str, data: bytes | bytearray, flags: int) -> None:
    with os.fdopen(open_file(path, os.O_WRONLY | os.O_CREAT | flags, 0o644), "wb") as file:
        file.write(data)


def _folders_of(names: Iterable[str]) -> list[str]:
    """Return the folders in which another interpreter finds these modules."""
    from importlib.util import find_spec  # noqa: PLC0415  # as above

    places: list[str] = []
    for spec in map(find_spec, names):
        if spec is not None:
            places += spec.submodule_search_locations or filter(os.path.isabs, [spec.origin or ""])
    return list(dict.fromkeys(map(os.path.dirname, places)))


_NUMBER = struct.Struct("=q")
#: where in the page it stands when the test process began
_BEGAN = 2 * _NUMBER.size


class Announced:
    """Tells all processes below the test process which test is running.

    The file is not memory-mapped: a process that truncates it would otherwise end this process.

    Args:
        folder: the folder of the campaign's processes.

    Attributes:
        number: the running test's; the last one's between tests, 0 before any.
    """

    def __init__(self, folder: str) -> None:
        self.number = 0
        self._now, self._tests = os.path.join(folder, NOW), os.path.join(folder, TESTS)
        page = bytearray(mmap.PAGESIZE)
        _NUMBER.pack_into(page, _BEGAN, BEGAN)
        _write(self._now, page, os.O_TRUNC)

    def begin(self, test: str) -> int:
        """Announce a test that begins. Return its number."""
        _write(self._tests, dumps(test).encode() + b"\n", os.O_APPEND)
        self.number += 1
        _write(self._now, _NUMBER.pack(self.number), 0)
        return self.number


class Now:
    """The number of the running test, in memory shared by the processes below the tests.

    Args:
        folder: the folder of the campaign's processes.
    """

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._names = [""]
        descriptor = open_file(os.path.join(folder, NOW), os.O_RDWR)
        try:
            self._memory = mmap.mmap(descriptor, mmap.PAGESIZE)
        finally:
            os.close(descriptor)

    @property
    def number(self) -> int:
        """The number of the running test; after a test still its number, 0 before the first."""
        number: int = _NUMBER.unpack_from(self._memory)[0]
        return number

    @property
    def began(self) -> int:
        """When the test process began, ns since the epoch."""
        began: int = _NUMBER.unpack_from(self._memory, _BEGAN)[0]
        return began

    def note_unwritten(self) -> None:
        """Note, in shared memory, that this process could not write its events."""
        _NUMBER.pack_into(self._memory, _NUMBER.size, 1)

    def name_of(self, number: int) -> str:
        """Return the node id of a test."""
        if number >= len(self._names):
            lines = read_file(os.path.join(self._folder, TESTS)).splitlines()
            self._names = ["", *map(loads, lines)]
        return self._names[number]


class ProcessWatch:
    """Watches, in the test process, the starts of processes by the tests.

    Args:
        on_unseen: called with each process that cannot report to the campaign.

    Attributes:
        codes: exit codes by process, negative for a signal.
        signalled: processes, and groups (negative), that the tests sent a signal to; ``ANY_PROCESS`` if they
            started what does so.
    """

    def __init__(self, on_unseen: Callable[[OutOfReach], None]) -> None:
        self.codes: dict[int, int] = {}
        self.signalled: set[int] = set()
        self._on_unseen = on_unseen
        listen(("os.kill", "os.killpg", *STARTS), self._on_audit_event)
        import subprocess  # noqa: PLC0415  # of no use to most processes below the tests

        kind: Any = subprocess.Popen
        wait, handle = os.waitpid, kind._handle_exitstatus

        def waitpid(pid: int, options: int, /) -> tuple[int, int]:
            found, status = wait(pid, options)
            if found:
                self.codes[found] = os.waitstatus_to_exitcode(status)
            return found, status

        def handled(popen: Any, status: int, *more: Any) -> None:
            handle(popen, status, *more)
            if popen.returncode is not None:
                self.codes[popen.pid] = popen.returncode

        os.waitpid, kind._handle_exitstatus = waitpid, handled

    def _on_audit_event(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event == "os.kill":
            self.signalled.add(arguments[0])
        elif event == "os.killpg":
            self.signalled.add(-arguments[0])
        else:
            if starts_a_killer(event, arguments):
                self.signalled.add(ANY_PROCESS)
            if process := out_of_reach(event, arguments):
                self._on_unseen(process)


def out_of_reach(event: str, arguments: tuple[Any, ...]) -> OutOfReach | None:
    """Return the process that an audit event starts if it cannot join the campaign; None if it can."""
    why = why_unseen(event, arguments)
    if why is None:
        return None
    files = sorted({os.path.realpath(file) for file in files_named(event, arguments)})
    # now: they may be gone when the test has ended
    imports = sorted({name for file in files for name in imports_of(file)})
    return OutOfReach(" ".join(command_of(event, arguments)[:3]), why, tuple(files), tuple(imports))
