"""Workers that only wait, for what may never come: until their time is up they need no processor.

A place that such a worker holds is lent to the next task. What a mutant of a message does to a program is
often just that: it waits. One place at a time stays one place: whoever asks for no neighbours has none.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Protocol

from .remains import started_below

#: seconds between two looks
PERIOD = 1.0
#: looks in a row that must find a worker waiting
_LOOKS = 3
#: the share of a processor under which it waits: nodes that poll, and announce themselves, take some
_SHARE = 0.25
#: workers at most, for each place
_MOST = 4
_TICK = 1 / os.sysconf("SC_CLK_TCK")


class Observed(Protocol):
    """A worker: its process, and the folder that processes below it know it by."""

    @property
    def pid(self) -> int: ...

    @property
    def processes(self) -> Path: ...


class Waiting:
    """Which workers only wait.

    Args:
        places: how many may be at work at a time.
    """

    def __init__(self, places: int) -> None:
        self._places = places
        self._used: dict[int, dict[int, float]] = {}
        self._still: dict[int, int] = {}
        self._looked = 0.0

    def has_place(self, workers: Iterable[Observed]) -> bool:
        """Whether one more may begin beside these, of which some may only wait."""
        here = list(workers)
        if len(here) < self._places:
            return True
        if self._places == 1 or len(here) >= _MOST * self._places:
            return False
        self._look(here)
        return len(here) - sum(self._still.get(one.pid, 0) >= _LOOKS for one in here) < self._places

    def _look(self, workers: list[Observed]) -> None:
        now = time.monotonic()
        since = now - self._looked
        if since < PERIOD:
            return
        self._looked = now
        used = {one.pid: _processor_time({one.pid, *started_below(one.processes)}) for one in workers}
        self._still = {
            pid: self._still.get(pid, 0) + 1
            for pid, seconds in used.items()
            if pid in self._used and _added(self._used[pid], seconds) < _SHARE * since
        }
        self._used = used


def _added(before: dict[int, float], now: dict[int, float]) -> float:
    """Processor seconds between two looks; without end where processes have begun or ended."""
    if before.keys() != now.keys():
        return float("inf")
    return sum(now.values()) - sum(before.values())


def _processor_time(processes: Iterable[int]) -> dict[int, float]:
    """Processor seconds by process, of those that are there."""
    found = {}
    for pid in processes:
        with suppress(OSError):
            fields = Path(f"/proc/{pid}/stat").read_text("ascii", "replace").rpartition(")")[2].split()
            found[pid] = (int(fields[11]) + int(fields[12])) * _TICK
    return found
