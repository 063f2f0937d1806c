"""Workers that only wait, for what may never come, and who may compute in their place.

A place that such a worker holds is lent to the next task. What a mutant of a message does to a program is
often just that: it waits. One place at a time stays one place: whoever asks for no neighbours has none.

Nothing is lent where nobody can tell waiting from being kept waiting: a process that gets little of a busy
machine is not idle. So what counts is what the tasks of a worker ask for, not what they get; and as long as
processors are short on the machine, whoever uses them, nothing is lent at all.

Of the token pool this is the controller's side: a pipe with one byte per free token, as many tokens as
processes may compute. A trunk is started with a token that the controller took for it; from then on it takes
and gives back by itself and says how many it holds, so that the tokens of a trunk that dies are not lost.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Protocol

from mutabot.border.time_used import Accounts, accounts_of, below, children, is_crowded, shortage

from .remains import by_mark

#: seconds between two looks
PERIOD = 1.0
#: looks in a row that must find a worker waiting
_LOOKS = 3
#: share of a processor under which a worker only waits: nodes that poll, and announce themselves, take some
_SHARE = 0.25
#: the share of the time in which some task may have had no processor while processors are not short
_SHORT = 0.2
#: workers at most, for each place
_MOST = 4


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
        self._accounts: dict[int, Accounts] = {}
        self._still: dict[int, int] = {}
        self._looked = 0.0
        self._shortage: float | None = None

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
        known, marked = children(), by_mark()
        accounts = {
            one.pid: accounts_of(below([one.pid, *marked.get(one.processes, ())], known)) for one in workers
        }
        is_short = self._is_short(since)
        self._still = {
            pid: self._still.get(pid, 0) + 1
            for pid, found in accounts.items()
            if not is_short and asks_for_little(self._accounts.get(pid), found, _SHARE * since)
        }
        self._accounts = accounts

    def _is_short(self, since: float) -> bool:
        """Whether processors were short since the last look."""
        before, self._shortage = self._shortage, shortage()
        if self._shortage is None:
            return is_crowded()
        return before is None or self._shortage - before > _SHORT * since


def asks_for_little(before: Accounts, now: Accounts, seconds: float) -> bool:
    """Whether the tasks of a worker have asked for fewer seconds of a processor between two looks.

    Not if any asks right now, if tasks have begun or ended, or if the kernel does not tell.
    """
    if not before or not now or before.keys() != now.keys():
        return False
    if any(one.is_asking for one in (*before.values(), *now.values())):
        return False
    asked = sum(one.ran + one.queued for one in now.values())
    return asked - sum(one.ran + one.queued for one in before.values()) < seconds


_BYTE = b"t"
#: bytes that a pipe holds at most
_MOST_TOKENS = 1 << 20


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
            os.read(self.reading, _MOST_TOKENS)
        self.give_back(self._size)

    def close(self) -> None:
        """Close both ends."""
        os.close(self.reading)
        os.close(self._writing)
