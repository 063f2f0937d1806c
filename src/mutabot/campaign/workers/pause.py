"""A pause: nothing new begins, and what is at work goes on to its end.

One byte in a pipe stands for "go on". Nobody reads it but who pauses, so that whoever wants to begin
something, trunks included, only looks whether it is there, and can wait for it as for anything else.
"""

from __future__ import annotations

import os
import threading
import time
from types import TracebackType
from typing import Self


class Pause:
    """Whether a campaign is paused; any thread may begin and end it. Use as a context manager.

    Attributes:
        reading: a descriptor that is readable while nothing is paused. It is never to be read from.
    """

    def __init__(self) -> None:
        self.reading, self._writing = os.pipe()
        self._lock = threading.Lock()
        self._began: float | None = None
        self._ended = float("-inf")
        self._before = 0.0
        self._is_closed = False
        os.write(self._writing, b"g")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._lock:
            self._is_closed = True
            os.close(self.reading)
            os.close(self._writing)

    @property
    def is_on(self) -> bool:
        """Whether it is paused."""
        return self._began is not None

    def begin(self) -> bool:
        """Pause; returns False if it was paused before, or is over."""
        with self._lock:
            if self._began is not None or self._is_closed:
                return False
            os.read(self.reading, 1)
            self._began = time.monotonic()
            return True

    def end(self) -> bool:
        """Go on; returns False if it was not paused, or is over."""
        with self._lock:
            if self._began is None or self._is_closed:
                return False
            self._ended = time.monotonic()
            self._before += self._ended - self._began
            self._began = None
            os.write(self._writing, b"g")
            return True

    def clock(self) -> float:
        """Seconds that count: those of pauses do not."""
        with self._lock:
            now = self._began if self._began is not None else time.monotonic()
            return now - self._before

    def lasted_until(self) -> float:
        """Until when (``time.monotonic``) the last pause lasted; now, while it does."""
        with self._lock:
            return self._ended if self._began is None else time.monotonic()
