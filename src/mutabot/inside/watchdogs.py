"""Limits of wall clock that the suite brings along: they must mean the same to every engine."""

from __future__ import annotations

import faulthandler
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic  # before a simulation takes over the clock
from typing import TYPE_CHECKING

from mutabot.border.events import Watched
from mutabot.inside.node_ids import node_id

if TYPE_CHECKING:
    import pytest  # processes below the tests need none


@contextmanager
def alarm_held() -> Iterator[None]:
    """Stop the process's alarm for the time of a block, and let a process forked in it have what is left.

    A fork inherits no alarm; and a trunk that waits for its branches has not used that time itself.
    """
    left, interval = signal.setitimer(signal.ITIMER_REAL, 0.0)
    try:
        yield
    finally:
        if left:
            signal.setitimer(signal.ITIMER_REAL, left, interval)


def watched(test: str, seconds: float, by: str) -> Watched:
    """The report that ``by`` ends this process with exit code 1 unless ``test`` ends in time."""
    return Watched(test, monotonic() + seconds, f"no end after {seconds:g} s of wall clock ({by})")


def watched_by_faulthandler(item: pytest.Item) -> Watched | None:
    """The same for pytest's own limit; None if there is none, or it only prints."""
    seconds, ends = _faulthandler(item.config)
    return watched(node_id(item), seconds, "faulthandler_timeout") if seconds > 0 and ends else None


def drop_idle_watchdog(item: pytest.Item) -> None:
    """Where faulthandler would only print, its thread must not keep a trunk from forking."""
    seconds, ends = _faulthandler(item.config)
    if seconds > 0 and not ends:
        faulthandler.cancel_dump_traceback_later()


def _faulthandler(config: pytest.Config) -> tuple[float, bool]:
    try:
        seconds = float(config.getini("faulthandler_timeout") or 0.0)
    except (ValueError, KeyError):  # pytest's plug-in is switched off
        return 0.0, False
    try:
        return seconds, bool(config.getini("faulthandler_exit_on_timeout"))
    except (ValueError, KeyError):  # an older pytest only prints
        return seconds, False
