"""Let Ctrl-C, and the end of a campaign's time, take effect where it is safe.

Python raises KeyboardInterrupt between any two instructions, also between the opening of a descriptor or
the start of a process and the moment from which on somebody looks after it. So the first Ctrl-C is kept for
the next time that the campaign waits, which is at most a few seconds away. A second one is not.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


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
        clock: the seconds by which ``until`` is meant.
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
