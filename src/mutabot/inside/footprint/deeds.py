"""What a test does to files, and to other things that a forked process would share: seen by audit events.

Python tells of an event before it does what the event stands for: files opened by name for writing, renamed
or deleted, folders made, databases, sockets that wait at an address, processes, shared memory. What C code
does by itself is not seen.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from mutabot.inside import FOLDER
from mutabot.inside.fork.private_files import is_below

_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_NAMELESS = getattr(os, "O_TMPFILE", 0)
#: events about a path, and what is done to it
_ON_PATHS = {
    "os.remove": "deletes",
    "os.rmdir": "deletes",
    "os.mkdir": "makes",
    "os.rename": "renames",
    "os.link": "links",
    "os.symlink": "links",
    "os.truncate": "writes",
    "os.chmod": "changes",
    "os.chown": "changes",
    "os.utime": "changes",
    "os.setxattr": "changes",
    "os.mkfifo": "makes",
}
_OWN_NAMES = {"tempfile.mkdtemp", "tempfile.mkstemp"}
_PROCESSES = {"subprocess.Popen", "os.posix_spawn", "os.system", "os.fork", "os.forkpty", "os.exec"}
_WATCHED = {
    "open", *_ON_PATHS, *_OWN_NAMES, *_PROCESSES, "sqlite3.connect", "socket.bind", "mmap.__new__",
}  # fmt: skip
#: how pytest calls the folder of its cache as long as it makes it
_NEW_CACHE = "/pytest-cache-files-"
#: what is no file of anybody's
_NOWHERE = ("/dev/", "/proc/", "/sys/")
#: words kept per test; the first tell enough
_KEPT = 20


@dataclass(frozen=True, slots=True)
class Deed:
    """One thing that was done: ``writes``, ``deletes`` … and the path, where it has one."""

    verb: str
    path: str = ""

    def __str__(self) -> str:
        return f"{self.verb} {self.path}" if self.path else self.verb


_STARTS = Deed("starts a process")


@dataclass(slots=True)
class Deeds:
    """Watches one process.

    Args:
        ignored: folders in which mutabot and pytest keep their own.

    Attributes:
        on_deed: told what is about to be done, before it is done; None while nobody asks.
        done: what the running test has done, with whether it outlives the test.
    """

    ignored: tuple[str, ...]
    on_deed: Callable[[Deed], None] | None = None
    done: dict[Deed, bool] = field(default_factory=dict)
    _is_on: bool = False
    _own: list[str] = field(default_factory=list)
    _pytests: str = ""

    def install(self) -> None:
        """Listen from now on; it cannot be taken back."""
        temporary = os.path.realpath(tempfile.gettempdir())
        self._pytests = os.path.join(temporary, "pytest-of-")
        sys.addaudithook(self._hear)

    def start(self) -> None:
        """A test begins."""
        self.done, self._own, self._is_on = {}, [], True

    def stop(self, own: str | None = None) -> None:
        """The test is over; ``own`` is the folder that was made for it alone."""
        self._is_on = False
        if own is not None:
            for deed in self.done:
                self.done[deed] = self.done[deed] and not is_below(deed.path, own)

    @property
    def has_started_processes(self) -> bool:
        """Whether the running test has started any."""
        return _STARTS in self.done

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self._is_on or event not in _WATCHED:
            return
        self._is_on = False  # what is done here to find out is nobody's business
        try:
            if event in _OWN_NAMES:
                self._own.append(_absolute(arguments[0]))
            else:
                self._note(_deed(event, arguments))
        finally:
            self._is_on = True

    def _note(self, deed: Deed | None) -> None:
        if deed is None or self._is_nobodys(deed):
            return
        if self.on_deed is not None:
            self.on_deed(deed)
        if deed in self.done or len(self.done) < _KEPT:
            is_own = not deed.path or any(is_below(deed.path, own) for own in self._own)
            self.done[deed] = self.done.get(deed, False) or not is_own

    def _is_nobodys(self, deed: Deed) -> bool:
        """Whether it is no file, our own, or one of the folders that pytest makes for each test.

        Nobody but a test deletes or renames our own, bar pytest, which makes its cache under another name.
        """
        path = deed.path
        is_removal = deed.verb in {"deletes", "renames"} and _NEW_CACHE not in path
        if path.startswith(_NOWHERE):
            return True
        if not is_removal and any(is_below(path, folder) for folder in self.ignored):
            return True
        return path.startswith(self._pytests) and path.removeprefix(self._pytests).count("/") <= 2


def _deed(event: str, arguments: tuple[Any, ...]) -> Deed | None:
    """What an event stands for. None for one that changes nothing."""
    if event == "open":
        path, _, flags = arguments
        is_write = isinstance(flags, int) and flags & _WRITES and (flags & _NAMELESS) != _NAMELESS
        if not is_write or isinstance(path, int) or os.path.isdir(path):  # a folder: a nameless file in it
            return None
        return Deed("writes", _absolute(path))
    if event in _ON_PATHS:
        return Deed(_ON_PATHS[event], _absolute(arguments[0]))
    if event == "sqlite3.connect":
        name = os.fsdecode(arguments[0]) if isinstance(arguments[0], str | bytes | os.PathLike) else ""
        is_private = name in ("", ":memory:") or ("mode=memory" in name and "cache=shared" not in name)
        return None if is_private else Deed("opens the database", _absolute(name))
    if event == "os.fork" and sys._getframe(3).f_code.co_filename.startswith(FOLDER):
        return None  # a branch of our own
    if event == "socket.bind":
        return None if _is_any_port(arguments[1]) else Deed(f"waits at the address {arguments[1]!r}")
    if event == "mmap.__new__":
        return Deed("maps shared memory") if arguments[0] != -1 else None
    return _STARTS


def _is_any_port(address: Any) -> bool:
    """Whether the system chooses an address that nobody else has."""
    return isinstance(address, tuple) and len(address) > 1 and address[1] == 0


def _absolute(path: Any) -> str:
    try:
        return os.path.abspath(os.fsdecode(path))
    except (TypeError, ValueError, OSError):  # a descriptor, or a folder that is gone
        return str(path)
