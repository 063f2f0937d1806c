"""What a Python process is to be: all that ``exec`` would have given it, as one message.

It is read off the arguments of ``_posixsubprocess.fork_exec``, with which ``subprocess`` and the spawn method
of ``multiprocessing`` start everything. Anything but a plain start of a program by this interpreter is None.
"""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import stat
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

#: how many arguments ``fork_exec`` has in the versions that are known
_ARGUMENTS = 23
#: options of the interpreter that say no more than an environment variable that is set, by flag
_OPTIONS = {"-B": "dont_write_bytecode"}
_SHEBANG_BYTES = 256
#: what ends a zip file, and how long before its end that may be
_ARCHIVE_END, _ARCHIVE_BYTES = b"PK\x05\x06", 22 + (1 << 16)
#: kinds of resource limits, <asm-generic/resource.h>
_LIMITS = 16
#: how many descriptors go with one message at most
MOST_DESCRIPTORS = 200


@dataclass(frozen=True, slots=True)
class Start:
    """A Python process that is to begin.

    Attributes:
        arguments: the whole command line, as the kernel would show it.
        executable: what ``sys.executable`` is to be.
        name: what the kernel is to call the process.
        kind: ``script``, ``module`` or ``command``.
        subject: the script's path, the module's name or the command's text.
        rest: ``sys.argv`` but for its first.
        environment: entries ``name=value``.
        targets: numbers of the descriptors that go with it, in this order; the first is no descriptor of the
            process but its working folder.
        namespaces: kinds of the namespaces whose descriptors come after these.
        umask, session, group, is_new_session, blocked, ignored: as they are to be; signals as masks, a group
            that is to be that of whoever asks as -1.
        limits: resource limits.
        processors, niceness: where and how it may run.
        may_start: whether it is to have a zygote of its own.
    """

    arguments: tuple[bytes, ...]
    executable: str
    name: bytes
    kind: str
    subject: bytes
    rest: tuple[bytes, ...]
    environment: tuple[bytes, ...]
    targets: tuple[int, ...]
    namespaces: tuple[str, ...]
    umask: int
    session: int
    group: int
    is_new_session: bool
    blocked: int
    ignored: int
    limits: tuple[tuple[int, int, int], ...]
    processors: tuple[int, ...]
    niceness: int
    may_start: bool

    def data(self) -> tuple[Any, ...]:
        """It as plain values, for ``marshal``."""
        return tuple(getattr(self, name) for name in self.__slots__)


@dataclass(frozen=True, slots=True)
class Program:
    """The program of a command line: the part of a ``Start`` that says what is run."""

    arguments: tuple[bytes, ...]
    executable: str
    name: bytes
    kind: str
    subject: bytes
    rest: tuple[bytes, ...]


def read_start(arguments: tuple[Any, ...], namespaces: tuple[str, ...]) -> tuple[Start, list[int]] | None:
    """The process that these arguments of ``fork_exec`` ask for, and descriptors to send with it.

    The first of the descriptors is new and the caller's to close. ``namespaces``: what the process that
    asks has left behind since its zygote was made. None for everything that is no plain start of a program.
    """
    if len(arguments) != _ARGUMENTS:
        return None
    (command, executables, close, passed, folder, environment, *pipes) = arguments[:12]
    _, errors, restores, is_new_session, group, gid, gids, uid, umask, before, _ = arguments[12:]
    if before is not None or not (gid is None and gids is None and uid is None):
        return None
    entries = tuple(environment) if environment is not None else _environment()
    program = _program([os.fsencode(one) for one in command], executables, entries)
    sources = _sources(pipes, [one for one in passed if one != errors] if close else None)
    if program is None or sources is None or len(sources) > MOST_DESCRIPTORS:
        return None
    try:
        own_folder = os.open("." if folder is None else folder, os.O_PATH | os.O_CLOEXEC | os.O_DIRECTORY)
    except OSError:
        return None  # the plain way knows how to say so
    if program.kind == "script" and not _is_readable(program.subject, own_folder):
        os.close(own_folder)
        return None
    status = _status()
    ignored = status["SigIgn"]
    if restores:
        ignored &= ~_mask(signal.SIGPIPE, signal.SIGXFSZ)
    start = Start(
        program.arguments,
        program.executable,
        program.name,
        program.kind,
        program.subject,
        program.rest,
        entries,
        tuple(sources),
        namespaces,
        umask=umask if umask >= 0 else status["Umask"],
        session=os.getsid(0),
        group=os.getpgid(0) if group < 0 and not is_new_session else group,
        is_new_session=bool(is_new_session),
        blocked=status["SigBlk"],
        ignored=ignored,
        limits=tuple((kind, *resource.getrlimit(kind)) for kind in range(_LIMITS)),
        processors=tuple(sorted(os.sched_getaffinity(0))),
        niceness=os.getpriority(os.PRIO_PROCESS, 0),
        may_start=False,
    )
    return start, [own_folder, *sources.values()]


def _sources(pipes: Sequence[int], passed: Sequence[int] | None) -> dict[int, int] | None:
    """Descriptor of the new process to descriptor of this one; ``passed``: None for all that live on."""
    reading, _, _, writing, _, errors = pipes
    given = {0: reading, 1: writing, 2: errors}
    sources = {number: (number if given[number] < 0 else given[number]) for number in range(3)}
    if passed is None:
        passed = [number for number in map(int, os.listdir("/proc/self/fd")) if _is_inherited(number)]
    sources.update((number, number) for number in passed if number > 2)
    standard = (number for number in range(3) if sources[number] == number)
    return sources if all(map(_is_inherited, standard)) else None


def _is_inherited(number: int) -> bool:
    """Whether a descriptor is there and outlives ``exec``."""
    try:
        return os.get_inheritable(number)
    except OSError:
        return False


def _program(
    arguments: list[bytes], executables: Sequence[bytes], environment: tuple[bytes, ...]
) -> Program | None:
    """What is run; None if it is not a Python program of this interpreter."""
    file = next((one for one in map(os.fsencode, executables) if os.access(one, os.X_OK)), None)
    if file is None or not arguments or os.path.isdir(file):
        return None
    name = os.path.basename(file)
    if not _is_this_interpreter(file):
        found = _behind_shebang(file, environment)
        if found is None or b"/" not in file:
            return None
        interpreter, shown = found
        name = name if shown == interpreter else os.path.basename(interpreter)
        return _read(interpreter, [shown, file, *arguments[1:]], name)
    if b"/" in arguments[0] and os.path.abspath(arguments[0]) != os.path.abspath(file):
        return None
    return _read(file, arguments, name)


def _read(interpreter: bytes, arguments: list[bytes], name: bytes) -> Program | None:
    """The command line of an interpreter in parts."""
    rest = arguments[1:]
    while rest and rest[0].startswith(b"-") and rest[0] not in (b"-c", b"-m"):
        flag = _OPTIONS.get(os.fsdecode(rest[0]))
        if flag is None or not getattr(sys.flags, flag):
            return None
        rest = rest[1:]
    kind = {b"-c": "command", b"-m": "module"}.get(rest[0], "script") if rest else None
    if kind is None or (kind != "script" and len(rest) < 2) or rest[0] == b"":
        return None
    subject, rest = (rest[0], rest[1:]) if kind == "script" else (rest[1], rest[2:])
    executable = os.path.abspath(os.fsdecode(interpreter))
    return Program(tuple(arguments), executable, name, kind, subject, tuple(rest))


def _is_this_interpreter(file: bytes) -> bool:
    """Whether a file is this interpreter, by this name or one beside it."""
    own = os.fsencode(sys.executable or "")
    is_beside = os.path.dirname(os.path.abspath(file)) == os.path.dirname(os.path.abspath(own))
    return bool(own) and is_beside and os.path.realpath(file) == os.path.realpath(own)


def _behind_shebang(file: bytes, environment: tuple[bytes, ...]) -> tuple[bytes, bytes] | None:
    """The interpreter that a script names, if it is this one, and how the process would see it called."""
    try:
        with open(file, "rb") as script:
            line = script.read(_SHEBANG_BYTES).partition(b"\n")[0]
    except OSError:
        return None
    words = line[2:].split()
    if line[:2] != b"#!" or not words:
        return None
    if words[0] == b"/usr/bin/env" and len(words) == 2 and b"=" not in words[1] and words[1][:1] != b"-":
        path = next((one[5:] for one in environment if one.startswith(b"PATH=")), b"")
        candidates = (os.path.join(folder, words[1]) for folder in path.split(b":") if folder)
        found = next((one for one in candidates if os.access(one, os.X_OK)), None)
        return (found, words[1]) if found is not None and _is_this_interpreter(found) else None
    return (words[0], words[0]) if len(words) == 1 and _is_this_interpreter(words[0]) else None


def _is_readable(path: bytes, folder: int) -> bool:
    """Whether a script is a file that can be read, seen from the folder in which the process begins."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK, dir_fd=folder)
    except OSError:
        return False
    try:
        status = os.fstat(descriptor)
        tail = os.pread(descriptor, _ARCHIVE_BYTES, max(0, status.st_size - _ARCHIVE_BYTES))
        is_byte_code = os.pread(descriptor, 4, 0)[2:] == b"\r\n"
        # folders, archives and byte code are run in other ways
        return stat.S_ISREG(status.st_mode) and _ARCHIVE_END not in tail and not is_byte_code
    except OSError:
        return False
    finally:
        os.close(descriptor)


def _environment() -> tuple[bytes, ...]:
    """The environment of this process as C code has it, which is what it leaves to others."""
    entries = ctypes.POINTER(ctypes.c_char_p).in_dll(ctypes.CDLL(None), "environ")
    found: list[bytes] = []
    while entries and (entry := entries[len(found)]) is not None:
        found.append(entry)
    return tuple(found)


def _status() -> dict[str, int]:
    """What the kernel tells of this thread, as numbers."""
    with open("/proc/thread-self/status", encoding="ascii", errors="replace") as file:
        fields = dict(line.rstrip("\n").split(":\t", 1) for line in file if ":\t" in line)
    masks = {name: int(fields[name], 16) for name in ("SigBlk", "SigIgn")}
    return {**masks, "Umask": int(fields["Umask"], 8)}


def _mask(*signals: int) -> int:
    return sum(1 << (one - 1) for one in signals)
