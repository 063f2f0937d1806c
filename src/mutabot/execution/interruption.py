"""Delay Ctrl-C, and the end of a campaign's time, until it is safe.

Python raises KeyboardInterrupt between any two instructions, also between the opening of a descriptor or
the start of a process and the moment from which on it is supervised. So the first Ctrl-C is kept for
the next time that the campaign waits, which is at most a few seconds away. A second one is not.

Ctrl-C may be ignored, as in what a script starts with ``nohup … &``. Other ways to end a campaign, and the
end of its time, take effect all the same.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


class OutOfTimeError(Exception):
    """The time of a campaign is up."""


class Interruption(KeyboardInterrupt):
    """Ctrl-C was pressed once; raised where the campaign waits and its state is consistent."""


class _InterruptionGuard:
    """Delays interruptions until they are safe, while a campaign runs.

    Attributes:
        may_raise: whether an interruption is safe right now.
        is_kept: whether one waits for that.
        is_late: whether the end of the time waits for that.
    """

    def __init__(self) -> None:
        self.may_raise = self.is_kept = self.is_late = False

    def interrupt(self) -> None:
        """Interrupt the campaign now if that is safe, else as soon as it is."""
        if self.may_raise:
            raise Interruption
        if self.is_kept:
            raise KeyboardInterrupt
        self.is_kept = True

    def let_go(self) -> None:
        """Raise Interruption if one was delayed, and OutOfTimeError if the time is up."""
        if self.is_kept:
            self.is_kept = False
            raise Interruption
        if self.is_late:
            self.is_late = False
            raise OutOfTimeError

    def set_time_up(self) -> None:
        """Note that the time is up."""
        if self.may_raise:
            raise OutOfTimeError
        self.is_late = True


_guard: _InterruptionGuard | None = None


def interrupt(number: int = signal.SIGINT, frame: FrameType | None = None) -> None:
    """Interrupt the campaign like Ctrl-C; a signal handler of the main thread."""
    if _guard is None:
        raise KeyboardInterrupt
    _guard.interrupt()


@contextmanager
def interruptions_kept() -> Iterator[None]:
    """Delay Ctrl-C inside the context until the campaign waits, or until the end of the block.

    Does nothing in other threads than the main one, in which Python handles no signals, and where
    another handler is installed. Where Ctrl-C is ignored it stays so.
    """
    global _guard  # noqa: PLW0603  # a process has one handler of each signal
    is_main = threading.current_thread() is threading.main_thread()
    before = signal.getsignal(signal.SIGINT)
    if _guard is not None or not is_main or before not in (signal.default_int_handler, signal.SIG_IGN):
        yield
        return
    guard = _guard = _InterruptionGuard()
    if before is signal.default_int_handler:
        signal.signal(signal.SIGINT, interrupt)
    try:
        yield
    finally:
        if before is signal.default_int_handler:
            signal.signal(signal.SIGINT, before)
        _guard = None
    guard.let_go()


@contextmanager
def limited(until: float, clock: Callable[[], float]) -> Iterator[None]:
    """Raise OutOfTimeError at the next wait inside the context once the time is up.

    Only inside ``interruptions_kept``, in whose threads and circumstances it does nothing either.

    Args:
        until: when that is, by the clock.
        clock: the seconds by which ``until`` is meant.
    """
    guard = _guard
    if guard is None:
        yield
        return

    def look(number: int, frame: FrameType | None) -> None:
        left = until - clock()
        if left > 0:
            signal.setitimer(signal.ITIMER_REAL, left)
        else:
            guard.set_time_up()

    before = signal.signal(signal.SIGALRM, look)
    signal.setitimer(signal.ITIMER_REAL, max(until - clock(), 1e-3))
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        guard.is_late = False


@contextmanager
def interruptible() -> Iterator[None]:
    """Let Ctrl-C take effect at once inside the context, including one that was delayed."""
    guard = _guard
    if guard is None:
        yield
        return
    guard.may_raise = True
    try:
        guard.let_go()
        yield
    finally:
        guard.may_raise = False
