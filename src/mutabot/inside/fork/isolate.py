"""Cutting a branch off from what it shares with its trunk: output, temporary files, random state."""

from __future__ import annotations

import fcntl
import os
import random
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from mutabot.frozen import frozen

from .event_loops import go_on_running, own_event_loops, running_loop
from .private_files import PrivateFiles, is_below, private_folders

_CHUNK = 1 << 16
#: bytes up to which a copy of a deleted file stays in memory, which is quicker
_SMALL = 1 << 20
#: where forks have their folders, in that of the process
_FORKS = "forks"
#: device, inode, position and flags of an open file: descriptors that agree in them share one opening
_Shared = tuple[int, int, int, int]


class Foot:
    """What a fork would change and a branch must have as the trunk had it."""

    def __init__(self) -> None:
        # random registers a hook that seeds anew in every child
        self._random: Any = random.getstate()
        self._loop = running_loop()
        sys.stdout.flush()
        sys.stderr.flush()

    def restore(self) -> None:
        """In the branch: put it back."""
        random.setstate(self._random)
        go_on_running(self._loop)


@frozen
class Apart:
    """How a process that is forked is kept apart from its parent.

    Attributes:
        log: device and inode of the parent's log; what leads there leads nowhere in a fork.
        home: the folder of the process's own.
        files: its private files; None if they are not.
        why_not: why it cannot be forked at all, in words, or None.
        folder: the process's own among its forks, in a fork.
    """

    log: tuple[int, int] | None
    home: str
    files: PrivateFiles | None
    why_not: str | None = None
    folder: str = ""

    def reason(self) -> str | None:
        """Why this process cannot be forked now as far as its files are concerned; None if it can."""
        if self.files is None:
            return self.why_not or "its files are not private"
        folders = private_folders(self.files.root)
        for path, mode in _written():
            if is_below(path, self.files.home):
                continue
            if mode == os.O_RDWR:  # a database knows which file it has opened, and a fork has another one
                return f"{path} is open for reading and writing"
            if not any(is_below(path, one) for one in folders):
                return f"{path} is open for writing"
        return None

    def go(self, name: str) -> Apart:
        """In a process that was just forked, while its parent waits: share nothing with it any more.

        ``name``: unlike that of any other fork. Raises OSError if that is not possible.
        """
        assert self.files is not None
        folder = os.path.join(self.home, _FORKS, name)
        os.makedirs(folder)
        files = self.files.go_on_apart(folder)
        isolate_files(self.log)
        own_event_loops()
        return Apart(self.log, self.home, files, folder=folder)


def _written() -> Iterator[tuple[str, int]]:
    """Paths of the files that are open for writing and have a name, and how they are open."""
    for descriptor, status in _descriptors():
        is_named = stat.S_ISREG(status.st_mode) and status.st_nlink > 0
        mode = fcntl.fcntl(descriptor, fcntl.F_GETFL) & os.O_ACCMODE
        if is_named and mode != os.O_RDONLY:
            yield os.readlink(f"/proc/self/fd/{descriptor}"), mode


def _descriptors() -> Iterator[tuple[int, os.stat_result]]:
    for name in os.listdir("/proc/self/fd"):
        with suppress(OSError):  # the descriptor of the listing itself
            yield int(name), os.fstat(int(name))


def isolate_files(log: tuple[int, int] | None, instead: int | None = None) -> None:
    """In a process that was just forked: stop reading and writing where its parent does.

    An open file has one position for parent and child; the child opens its own. Of a deleted temporary file,
    such as those that pytest captures output in, it makes a copy. What leads to the parent's log leads
    elsewhere.

    Args:
        log: device and inode of the parent's log; None if there is none.
        instead: descriptor of the child's own log; None for nowhere.
    """
    found = list(_descriptors())  # before any is opened here
    nowhere = os.open(os.devnull, os.O_WRONLY)
    copies: dict[_Shared, int] = {}
    for descriptor, status in found:
        if (status.st_dev, status.st_ino) == log:
            target = nowhere if instead is None else instead
            os.dup2(target, descriptor, inheritable=os.get_inheritable(descriptor))
        elif stat.S_ISREG(status.st_mode):
            _renew(descriptor, status, copies)
    for descriptor in (nowhere, *copies.values()):
        os.close(descriptor)


def _renew(descriptor: int, status: os.stat_result, copies: dict[_Shared, int]) -> None:
    """Let a descriptor lead to the same file, but to an opening of it that is this process's own."""
    position, flags = os.lseek(descriptor, 0, os.SEEK_CUR), fcntl.fcntl(descriptor, fcntl.F_GETFL)
    shared = (status.st_dev, status.st_ino, position, flags)
    if shared not in copies:
        is_deleted = status.st_nlink == 0
        if is_deleted and flags & os.O_ACCMODE == os.O_RDONLY:
            return
        opened = _copy(descriptor) if is_deleted else _opened_again(descriptor, status, position, flags)
        if opened is None:
            return
        copies[shared] = opened
    os.dup2(copies[shared], descriptor, inheritable=os.get_inheritable(descriptor))


def _opened_again(descriptor: int, status: os.stat_result, position: int, flags: int) -> int | None:
    """The same file opened once more; None if it is ours, in a folder that tests do not see."""
    path = os.readlink(f"/proc/self/fd/{descriptor}")
    try:
        opened = os.open(path, flags & ~(os.O_CREAT | os.O_EXCL | os.O_TRUNC) | os.O_CLOEXEC)
    except FileNotFoundError:
        return None
    os.lseek(opened, position, os.SEEK_SET)
    return opened


def _copy(descriptor: int) -> int:
    """A private copy of a file, at the same position."""
    position = os.lseek(descriptor, 0, os.SEEK_CUR)
    if os.fstat(descriptor).st_size <= _SMALL:
        copied = os.memfd_create("copy")
    else:
        with tempfile.TemporaryFile(buffering=0) as file:
            copied = os.dup(file.fileno())
    offset = 0
    while chunk := os.pread(descriptor, _CHUNK, offset):
        offset += os.pwrite(copied, chunk, offset)
    os.lseek(copied, position, os.SEEK_SET)
    return copied
