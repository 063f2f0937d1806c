"""Cutting a branch off from what it shares with its trunk: output, temporary files, random state."""

from __future__ import annotations

import fcntl
import os
import random
import stat
import sys
import tempfile
from typing import Any

_CHUNK = 1 << 16


class Foot:
    """What a fork would change and a branch must have as the trunk had it."""

    def __init__(self) -> None:
        # random registers a hook that seeds anew in every child
        self._random: Any = random.getstate()
        sys.stdout.flush()
        sys.stderr.flush()

    def restore(self) -> None:
        """In the branch: put it back."""
        random.setstate(self._random)


def isolate_files(log: tuple[int, int] | None, instead: int | None = None) -> None:
    """In a process that was just forked: stop writing where its parent writes.

    Deleted temporary files, such as those that pytest captures output in, share one position between parent
    and child; the child goes on with private copies. What leads to the parent's log leads elsewhere.

    Args:
        log: device and inode of the parent's log; None if there is none.
        instead: descriptor of the child's own log; None for nowhere.
    """
    nowhere = os.open(os.devnull, os.O_WRONLY)
    copies: dict[tuple[int, int], int] = {}
    for name in os.listdir("/proc/self/fd"):
        descriptor = int(name)
        try:
            status = os.fstat(descriptor)
        except OSError:  # the descriptor of the listing itself
            continue
        identity = (status.st_dev, status.st_ino)
        if identity == log:
            target = nowhere if instead is None else instead
            os.dup2(target, descriptor, inheritable=os.get_inheritable(descriptor))
        elif stat.S_ISREG(status.st_mode) and status.st_nlink == 0 and _is_written(descriptor):
            if identity not in copies:
                copies[identity] = _copy(descriptor)
            os.dup2(copies[identity], descriptor, inheritable=os.get_inheritable(descriptor))
    for descriptor in (nowhere, *copies.values()):
        os.close(descriptor)


def _is_written(descriptor: int) -> bool:
    return fcntl.fcntl(descriptor, fcntl.F_GETFL) & os.O_ACCMODE != os.O_RDONLY


def _copy(descriptor: int) -> int:
    """A private copy of a file, at the same position."""
    position = os.lseek(descriptor, 0, os.SEEK_CUR)
    with tempfile.TemporaryFile(buffering=0) as file:
        offset = 0
        while chunk := os.pread(descriptor, _CHUNK, offset):
            file.write(chunk)
            offset += len(chunk)
        copied = os.dup(file.fileno())
    os.lseek(copied, position, os.SEEK_SET)
    return copied
