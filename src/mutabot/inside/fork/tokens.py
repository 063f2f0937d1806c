"""Tokens: whoever computes holds one, and there are as many as processes may run at a time.

The pool is a pipe with one byte per free token. A trunk hands its own token to the branch it forks and
waits for another one, which is either free in the pool or comes back with a branch that has ended. Branches
never touch the pool: the trunk gives back for them, however they ended.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress

BYTE = b"t"


class Tokens:
    """A trunk's side of the pool.

    Args:
        reading, writing: descriptors of the pool's ends; the reading end does not block.
        on_change: told how many tokens this trunk and its branches hold.

    A trunk begins with the token its starter took for it.
    """

    def __init__(self, reading: int, writing: int, on_change: Callable[[int], None]) -> None:
        self.reading = reading
        self._writing = writing
        self._on_change = on_change
        self.held = 1

    def take(self) -> bool:
        """Take a free token, if there is one."""
        try:
            taken = bool(os.read(self.reading, 1))
        except BlockingIOError:
            return False
        if taken:
            self.held += 1
            self._on_change(self.held)
        return taken

    def give_back(self) -> None:
        """Put one token back into the pool."""
        self.held -= 1
        self._on_change(self.held)
        with suppress(BlockingIOError):  # it is full, of what no trunk has put there
            os.write(self._writing, BYTE)

    def close(self) -> None:
        """In a branch: a mutant cannot write into the pool."""
        os.close(self.reading)
        os.close(self._writing)
