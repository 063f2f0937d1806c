"""Which test is running: told by the test process, known to all processes below it at no cost."""

from __future__ import annotations

import json
import mmap
import os
import struct

from mutabot.border.processes import NOW, TESTS

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
