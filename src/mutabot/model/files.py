"""Open files safely in folders that programs under test can write to.

A pipe in the place of a file would block the process that opens it for ever, a link would lead elsewhere.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import suppress

#: bound before a test can replace it, as by ``mock_open``
real_open = open
_SAFELY = os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC
_WRITING = os.O_WRONLY | os.O_RDWR


def open_file(path: str | os.PathLike[str], flags: int, mode: int = 0o600) -> int:
    """Open a regular file without blocking or following links; a file to write to must be owned and unlinked.

    Raises OSError for anything else.
    """
    descriptor = os.open(path, (flags & ~os.O_TRUNC) | _SAFELY, mode)
    if not _is_file(os.fstat(descriptor), flags):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "something else is in the place of this file", os.fspath(path))
    if flags & os.O_TRUNC:
        os.ftruncate(descriptor, 0)
    return descriptor


def _is_file(status: os.stat_result, flags: int) -> bool:
    is_ours = os.geteuid() in (0, status.st_uid) and status.st_nlink <= 1
    return stat.S_ISREG(status.st_mode) and (is_ours or not flags & _WRITING)


def read_file(path: str | os.PathLike[str], most: int = -1) -> bytes:
    """Read a file, or its first ``most`` bytes. Raises OSError if it is not a regular file."""
    with os.fdopen(open_file(path, os.O_RDONLY), "rb") as file:
        return file.read(most)


def copy_file(path: str | os.PathLike[str], target: str | os.PathLike[str]) -> None:
    """Copy a file without its holes, which may be larger than any disk. Raises OSError as ``read_file``."""
    source = open_file(path, os.O_RDONLY)
    try:
        copy = os.open(target, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, 0o600)
        try:
            os.ftruncate(copy, os.fstat(source).st_size)
            for start, end in _parts(source):
                at = os.lseek(copy, start, os.SEEK_SET)
                while at < end and (done := os.sendfile(copy, source, at, end - at)):
                    at += done
        finally:
            os.close(copy)
    finally:
        os.close(source)


def _parts(descriptor: int) -> Iterator[tuple[int, int]]:
    """Yield the parts of a file that hold anything."""
    end = 0
    with suppress(OSError):  # there is nothing beyond
        while True:
            start = os.lseek(descriptor, end, os.SEEK_DATA)
            end = os.lseek(descriptor, start, os.SEEK_HOLE)
            yield start, end
