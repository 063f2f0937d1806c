"""Ctrl-C takes effect where it is safe: while a campaign waits for its workers.

Python raises KeyboardInterrupt between any two instructions, also between the opening of a descriptor or
the start of a process and the moment from which on somebody looks after it. So the first Ctrl-C is kept for
the next time that the campaign waits, which is at most a few seconds away. A second one is not.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class _Keeper:
    """The handler of SIGINT while a campaign runs.

    Attributes:
        may_raise: whether an interruption is safe right now.
        is_kept: whether one waits for that.
    """

    def __init__(self) -> None:
        self.may_raise = self.is_kept = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if self.may_raise or self.is_kept:
            raise KeyboardInterrupt
        self.is_kept = True

    def let_go(self) -> None:
        """Raise KeyboardInterrupt if one is kept."""
        if self.is_kept:
            self.is_kept = False
            raise KeyboardInterrupt


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
