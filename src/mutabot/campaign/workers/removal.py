"""Removing a folder in which a process worked, whatever that process has made of it."""

from __future__ import annotations

import fcntl
import os
import shutil
import stat
import struct
import subprocess
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

#: <linux/fs.h>: to read and to set the flags of a file; those that keep it from being changed or deleted
_GET_FLAGS, _SET_FLAGS = 0x80086601, 0x40086602
_IMMUTABLE, _APPEND_ONLY = 0x10, 0x20
_FLAGS = struct.Struct("@l")
_Error = tuple[type[BaseException], BaseException, TracebackType]


def remove_folder(folder: Path) -> str | None:
    """Remove a folder with all that is in it. Returns why it is still there, in words; None if it is gone."""
    problems: list[str] = []

    def let_in(function: Any, path: str, error: _Error) -> None:
        if not isinstance(error[1], FileNotFoundError):
            problems.append(f"{path} ({getattr(error[1], 'strerror', None) or error[1]})")
        if isinstance(error[1], PermissionError):
            _free(Path(path))

    for _ in range(2):  # the second time all is free
        try:
            shutil.rmtree(folder, onerror=let_in)
        except (RecursionError, OSError) as error:  # more folders in each other than Python can go down
            problems.append(f"{folder} ({getattr(error, 'strerror', None) or error})")
            subprocess.run(["rm", "-rf", "--", folder], check=False, stderr=subprocess.DEVNULL)
        if not os.path.lexists(folder):
            return None
    return problems[-1] if problems else f"{folder} (something is written there)"


def _free(path: Path) -> None:
    """Something cannot be removed: let its owner change all that is in its folder, and in itself.

    Folders may be closed to their owner, as those of private files are, and files may be immutable. Nothing
    is changed through a link: what it leads to is the user's.
    """
    folder = path.parent
    _open_up(folder)
    with suppress(OSError):
        for one in [path, *folder.iterdir()]:
            _open_up(one)
    if not path.is_symlink() and path.is_dir():
        with suppress(OSError):
            for one in path.iterdir():
                _open_up(one)


def _open_up(path: Path) -> None:
    with suppress(OSError):
        mode = path.lstat().st_mode
        if not stat.S_ISDIR(mode) and not stat.S_ISREG(mode):
            return
        _make_mutable(path)
        if stat.S_ISDIR(mode):
            path.chmod(0o700)
            _make_mutable(path)


def _make_mutable(path: Path) -> None:
    with suppress(OSError):
        flags = os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC
        descriptor = os.open(path, flags)
        try:
            found = _FLAGS.unpack(fcntl.ioctl(descriptor, _GET_FLAGS, bytes(_FLAGS.size)))[0]
            if found & (_IMMUTABLE | _APPEND_ONLY):
                fcntl.ioctl(descriptor, _SET_FLAGS, _FLAGS.pack(found & ~(_IMMUTABLE | _APPEND_ONLY)))
        finally:
            os.close(descriptor)
