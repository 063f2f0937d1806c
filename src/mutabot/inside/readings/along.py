"""Probes along the way of a test: read after its commands, at moments that follow from their number alone.

The first readings come after every ``stride``-th command; once there are many, after every second of these,
and so on. So the original and its mutants are read at the same moments, however busy the machine is.
"""

from __future__ import annotations

import random
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from time import perf_counter  # tests may replace those of the module
from typing import Any

from mutabot.frozen import frozen

from .probes import Reading

#: readings before the first thinning, and between any later two
FIRST, NEXT = 100, 50
#: seconds beyond which a reading is too slow to be repeated
_SLOW = 0.05
#: how often a quick reading is timed once more: the least counts
_MORE = 2


@dataclass(slots=True)
class Along:
    """The readings of the running test.

    Attributes:
        read: reads the probes.
        entries: number of the call after which it was read, parts that differ from the reading before, and
            whether these are all parts there are.
    """

    read: Callable[[], Reading]
    entries: list[tuple[int, dict[str, Any], bool]] = field(default_factory=list)
    _step: int = 0
    _commands: int = 0
    _thins_at: int = FIRST
    _last: dict[str, Any] | None = None

    def start(self, stride: int) -> None:
        """A new test begins; it is not read along the way if ``stride`` is 0."""
        self.entries, self._last = [], None
        self._step, self._commands, self._thins_at = stride, 0, FIRST

    def stop(self) -> None:
        """What comes now is no more part of the test."""
        self._step = 0

    def after(self, call: int) -> None:
        """A command, the test's ``call``-th call, is over."""
        self._commands += 1
        if not self._step or self._commands % self._step:
            return
        if threading.current_thread() is not threading.main_thread():
            return
        values = self.read().values
        last = self._last
        if last is not None and last.keys() == values.keys():
            changed = {key: value for key, value in values.items() if value != last[key]}
            self.entries.append((call, changed, False))
        else:
            self.entries.append((call, values, True))
        self._last = values
        if len(self.entries) >= self._thins_at:
            self._thins_at += NEXT
            self._step *= 2


@frozen
class Rehearsal:
    """What is known of reading the probes once more.

    Attributes:
        seconds: of processor time; None if they cannot be read along the way.
        why_not: why not, or None.
    """

    seconds: float | None = None
    why_not: str | None = None


def rehearse(read: Callable[[], Reading]) -> tuple[Reading, Rehearsal]:
    """The probes, and whether they could be read along the way as well: reading them must change nothing."""
    first, took, _ = _timed(read)
    if not first.values:
        return first, Rehearsal()
    drawn = _random_state()
    second, took_again, seconds = _timed(read)
    slow = min(took, took_again)  # the system may do other things meanwhile
    if slow > _SLOW:
        return first, Rehearsal(None, f"reading them takes {1e3 * slow:.0f} ms")
    seconds = min(seconds, *(_timed(read)[2] for _ in range(_MORE)))
    if drawn != _random_state():
        return first, Rehearsal(None, "reading them draws random numbers")
    for key in first.values.keys() | second.values.keys():
        if not _is_same(first.values.get(key), second.values.get(key)):
            return first, Rehearsal(None, f"{key} changes when it is read twice")
    return first, Rehearsal(seconds)


def _timed(read: Callable[[], Reading]) -> tuple[Reading, float, float]:
    """The probes, and the seconds that reading them took: of wall clock, and of processor time."""
    began, used = perf_counter(), time.thread_time()
    reading = read()
    return reading, perf_counter() - began, time.thread_time() - used


def _is_same(one: Any, other: Any) -> bool:
    return repr(one) == repr(other)  # NaN is as good as NaN


def _random_state() -> Any:
    numpy = sys.modules.get("numpy.random")
    state = numpy.get_state() if numpy is not None and hasattr(numpy, "get_state") else ()
    return random.getstate(), [part.tobytes() if hasattr(part, "tobytes") else part for part in state]
