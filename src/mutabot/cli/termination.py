"""SIGTERM ends a command as Ctrl-C does: nothing is lost, and nothing is left behind."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Termination:
    """The handler of SIGTERM.

    Attributes:
        has_come: whether there was one.
    """

    def __init__(self) -> None:
        self.has_come = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Do what Ctrl-C does at this moment."""
        self.has_come = True
        on_interrupt = signal.getsignal(signal.SIGINT)
        if callable(on_interrupt):
            on_interrupt(signal.SIGINT, frame)


@contextmanager
def terminated_like_ctrl_c() -> Iterator[Termination]:
    """Inside, SIGTERM does what Ctrl-C does.

    Does nothing in other threads than the main one, which Python tells nothing of signals, and where somebody
    else handles it already or it is ignored.
    """
    termination = Termination()
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield termination
        return
    signal.signal(signal.SIGTERM, termination)
    try:
        yield termination
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
