"""Which files of the project are opened while the baseline runs, by whatever process: the kernel tells."""

from __future__ import annotations

import ctypes
import os
import struct
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType

_IN_OPEN, _IN_Q_OVERFLOW, _IN_ONLYDIR = 0x20, 0x4000, 0x01000000
_EVENT = struct.Struct("iIII")  # watch, mask, cookie, length of the name that follows
_BYTES = 1 << 16


class OpenedFiles:
    """Notes which files in some folders are opened; use as a context manager.

    Args:
        root: the project's folder.
        folders: the folders in it to look at, relative to it.

    Attributes:
        opened: the files, relative to the root, once the watch is over; None where the kernel could not tell
            about all of them.
    """

    def __init__(self, root: Path, folders: Iterable[str]) -> None:
        self.opened: set[str] | None = None
        self._root, self._names = root, sorted(folders)
        self._folders: dict[int, str] = {}
        self._descriptor = -1

    def __enter__(self) -> OpenedFiles:
        libc = ctypes.CDLL(None, use_errno=True)
        self._descriptor = libc.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC)
        if self._descriptor < 0:
            return self
        for name in self._names:
            folder = self._root / name
            watch = libc.inotify_add_watch(self._descriptor, os.fsencode(folder), _IN_OPEN | _IN_ONLYDIR)
            if watch < 0 and folder.is_dir():
                self._close()  # too many folders for the kernel
                return self
            self._folders[watch] = "" if name == "." else f"{name}/"
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._descriptor >= 0:
            self.opened = self._read()
            self._close()

    def _close(self) -> None:
        os.close(self._descriptor)
        self._descriptor = -1

    def _read(self) -> set[str] | None:
        found: set[str] = set()
        while True:
            try:
                data = os.read(self._descriptor, _BYTES)
            except BlockingIOError:
                return found
            position = 0
            while position < len(data):
                watch, mask, _, length = _EVENT.unpack_from(data, position)
                position += _EVENT.size + length
                if mask & _IN_Q_OVERFLOW:
                    return None
                name = data[position - length : position].rstrip(b"\0")
                if name:
                    found.add(self._folders.get(watch, "") + os.fsdecode(name))
