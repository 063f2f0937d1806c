"""The controller's side of the token pool: as many tokens as processes may compute at a time.

The pool is a pipe with one byte per free token. A trunk is started with a token that the controller took
for it; from then on the trunk takes and gives back by itself and says how many it holds, so that the tokens
of a trunk that dies are not lost.
"""

from __future__ import annotations

import os
from contextlib import suppress

_BYTE = b"t"
#: bytes that a pipe holds at most
_MOST = 1 << 20


class TokenPool:
    """A pool of ``size`` tokens, all of them free at first."""

    def __init__(self, size: int) -> None:
        self._size = size
        self.reading, self._writing = os.pipe()
        # whatever a test puts there or takes away, nobody may wait for it
        os.set_blocking(self.reading, False)
        os.set_blocking(self._writing, False)
        self.give_back(size)

    @property
    def descriptors(self) -> tuple[int, int]:
        """Reading and writing end, for a trunk."""
        return self.reading, self._writing

    def take(self) -> bool:
        """Take a free token, if there is one."""
        try:
            return bool(os.read(self.reading, 1))
        except BlockingIOError:
            return False

    def give_back(self, count: int) -> None:
        """Put tokens back; never more than there are."""
        if count > 0:
            with suppress(BlockingIOError):
                os.write(self._writing, _BYTE * min(count, self._size))

    def refill(self) -> None:
        """Make all tokens free again; only when nobody holds any."""
        with suppress(BlockingIOError):
            os.read(self.reading, _MOST)
        self.give_back(self._size)

    def close(self) -> None:
        """Close both ends."""
        os.close(self.reading)
        os.close(self._writing)
