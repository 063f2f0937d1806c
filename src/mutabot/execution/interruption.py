"""Ctrl-C takes effect where it is safe, while a campaign waits for its workers; and a campaign can pause.

Python raises KeyboardInterrupt between any two instructions, also between the opening of a descriptor or
the start of a process and the moment from which on somebody looks after it. So the first Ctrl-C is kept for
the next time that the campaign waits, which is at most a few seconds away. A second one is not.

In a pause nothing new begins, and what is at work goes on to its end. One byte in a pipe stands for "go on".
Nobody reads it but who pauses, so that whoever wants to begin something, trunks included, only looks whether
it is there, and can wait for it as for anything else.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Self


class OutOfTimeError(Exception):
    """The time of a campaign is up."""


class _Keeper:
    """The handler of SIGINT while a campaign runs.

    Attributes:
        may_raise: whether an interruption is safe right now.
        is_kept: whether one waits for that.
        is_late: whether the end of the time waits for that.
    """

    def __init__(self) -> None:
        self.may_raise = self.is_kept = self.is_late = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if self.may_raise or self.is_kept:
            raise KeyboardInterrupt
        self.is_kept = True

    def let_go(self) -> None:
        """Raise KeyboardInterrupt if one is kept, and OutOfTimeError if the time is up."""
        if self.is_kept:
            self.is_kept = False
            raise KeyboardInterrupt
        if self.is_late:
            self.is_late = False
            raise OutOfTimeError

    def be_late(self) -> None:
        """The time is up."""
        if self.may_raise:
            raise OutOfTimeError
        self.is_late = True


@contextmanager
def interruptions_kept() -> Iterator[None]:
    """Inside, Ctrl-C is kept until the campaign waits, or until the end of the block.

    Does nothing in other threads than the main one, which Python tells nothing of signals, and where
    somebody else handles them already.
    """
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    keeper = _Keeper()
    signal.signal(signal.SIGINT, keeper)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    keeper.let_go()


@contextmanager
def limited(until: float, clock: Callable[[], float]) -> Iterator[None]:
    """Inside, OutOfTimeError is raised at the next wait once the time is up.

    Only inside ``interruptions_kept``, in whose threads and circumstances it does nothing either.

    Args:
        until: when that is, by the clock.
        clock: seconds, which may stand still for a while.
    """
    keeper = signal.getsignal(signal.SIGINT)
    if not isinstance(keeper, _Keeper):
        yield
        return

    def look(number: int, frame: FrameType | None) -> None:
        left = until - clock()
        if left > 0:
            signal.setitimer(signal.ITIMER_REAL, left)
        else:
            keeper.be_late()

    before = signal.signal(signal.SIGALRM, look)
    signal.setitimer(signal.ITIMER_REAL, max(until - clock(), 1e-3))
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        keeper.is_late = False


@contextmanager
def interruptible() -> Iterator[None]:
    """Inside, Ctrl-C takes effect at once, and so does one that was kept."""
    keeper = signal.getsignal(signal.SIGINT)
    if not isinstance(keeper, _Keeper):
        yield
        return
    keeper.may_raise = True
    try:
        keeper.let_go()
        yield
    finally:
        keeper.may_raise = False


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
