"""Measure how much time processes have used on a shared machine.

Time for which its tasks waited for a processor does not count. So a limit of wall clock means the same on a
busy machine as on a quiet one, as far as the kernel keeps accounts: a task that waits for a message asks for
nothing; one that wants to compute and has no processor looks just as idle to a plain clock.
"""

from __future__ import annotations

import os
import resource
from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import cache

from mutabot.frozen import frozen
from mutabot.model.clocks import monotonic
from mutabot.model.files import real_open

_PRESSURE = "/proc/pressure/cpu"


@frozen
class Account:
    """The time that a task has used until now.

    Attributes:
        ran: seconds on a processor.
        queued: seconds for which it could have run and had none.
    """

    ran: float
    queued: float


#: by the number of the task; None where the kernel keeps no such accounts
Accounts = Mapping[int, Account] | None


def accounts_of(processes: Iterable[int]) -> Accounts:
    """Return the accounts of all tasks of those of these processes that exist."""
    if not _are_kept():
        return None
    found = {}
    for pid in processes:
        for task in _names(f"/proc/{pid}/task"):
            with suppress(OSError, IndexError, ValueError):
                ran, queued = _read(f"/proc/{pid}/task/{task}/schedstat").split()[:2]
                found[int(task)] = Account(int(ran) * 1e-9, int(queued) * 1e-9)
    return found


def descendants(roots: Iterable[int]) -> set[int]:
    """Return these processes and all their descendants."""
    found, due = set[int](), list(roots)
    children = _children_of if _are_listed() else _all_children().get
    while due:
        pid = due.pop()
        if pid not in found:
            found.add(pid)
            due += children(pid, ())
    return found


@cache
def _are_listed() -> bool:
    """Return whether the kernel lists the children of a task, as searching for them is slow."""
    return os.path.exists("/proc/thread-self/children")  # noqa: PTH110  # pathlib takes long to load


def _children_of(pid: int, nothing: Iterable[int]) -> Iterable[int]:
    """Return the children of all tasks of a process."""
    found = list(nothing)
    for task in _names(f"/proc/{pid}/task"):
        with suppress(OSError, ValueError):
            found += map(int, _read(f"/proc/{pid}/task/{task}/children").split())
    return found


def _all_children() -> dict[int, list[int]]:
    """Return the children of every process that has any."""
    found: dict[int, list[int]] = {}
    for name in _names("/proc"):
        if name.isdigit():
            with suppress(OSError, IndexError, ValueError):
                parent = int(_read(f"/proc/{name}/stat").rpartition(")")[2].split()[1])
                found.setdefault(parent, []).append(int(name))
    return found


def ran_below() -> float:
    """Return the processor seconds of all processes below this one, both ended and running."""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = ended.ru_utime + ended.ru_stime
    try:
        os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:  # there is none: to look for them would take long
        return seconds
    here = os.getpid()
    found = accounts_of(descendants([here]) - {here})
    return seconds + sum(account.ran for account in (found or {}).values())


def shortage() -> float | None:
    """Return the seconds in which some task waited for a processor since boot; None if not recorded."""
    try:
        for line in _read(_PRESSURE).splitlines():
            kind, *fields = line.split()
            if kind == "some":
                return int(dict(field.split("=") for field in fields)["total"]) * 1e-6
    except (OSError, ValueError, KeyError):
        pass
    return None


def is_crowded() -> bool:
    """Return whether more tasks want to run, now or in the last minute, than there are processors."""
    processors = len(os.sched_getaffinity(0))
    with suppress(OSError, ValueError, IndexError):
        line = next(line for line in _read("/proc/stat").splitlines() if line.startswith("procs_running"))
        if int(line.split()[1]) - 1 > processors:  # this one runs as well
            return True
    return os.getloadavg()[0] > processors


@cache
def _are_kept() -> bool:
    """Return whether the kernel keeps accounts: it must have one for this process."""
    with suppress(OSError, IndexError, ValueError):
        return int(_read("/proc/self/schedstat").split()[0]) > 0
    return False


def _names(folder: str) -> list[str]:
    with suppress(OSError):
        return os.listdir(folder)  # noqa: PTH208  # three times as fast
    return []


def _read(path: str) -> str:
    with real_open(path, encoding="ascii", errors="replace") as file:
        return file.read()


#: a limit of wall clock is extended to this many times its length at most
MOST = 10.0
#: the share of the time in the queue, and that in which processors were short, which make a time-out doubtful
_QUEUED, _SHORT = 0.1, 0.5
_NONE = Account(0.0, 0.0)


@frozen
class TimeUsed:
    """The time that processes have used since a start time.

    Attributes:
        began: the moment (``time.monotonic``).
        accounts: those of its tasks.
        shortage: see ``demand.shortage``.
    """

    began: float
    accounts: Accounts
    shortage: float | None

    @classmethod
    def from_now(cls, processes: Iterable[int] = ()) -> TimeUsed:
        """Return the accounts of these processes from now on; later processes count from their start."""
        return cls(monotonic(), accounts_of(processes), shortage())

    @property
    def age(self) -> float:
        """Seconds since the start time."""
        return monotonic() - self.began

    def remaining(
        self, wall: float, processor: float | None, processes: Iterable[int]
    ) -> tuple[float, float | None]:
        """Return the seconds left in the budgets of wall-clock and processor time without further delay.

        0 or less: used up. The wall clock is also used up once ``MOST`` times its budget has passed.
        """
        passed = self.age
        ran, queued = self._had(processes)
        left = 0.0 if passed >= MOST * wall else wall - (passed - min(queued, passed))
        return left, None if processor is None else processor - ran

    def hindrance(self, processes: Iterable[int] = ()) -> str | None:
        """Return why the time limit is inconclusive, or None if the machine was quiet enough."""
        passed = self.age
        _, queued = self._had(processes)
        if min(queued, passed) >= _QUEUED * passed:
            share = min(1.0, queued / passed) if passed else 1.0
            return f"it stood in the queue for a processor for {share:.0%} of the time"
        total = shortage()
        if self.shortage is None or total is None:
            return "more tasks wanted to run than there are processors" if is_crowded() else None
        short = (total - self.shortage) / passed if passed else 0.0
        return f"processors were short for {min(1.0, short):.0%} of the time" if short >= _SHORT else None

    def _had(self, processes: Iterable[int]) -> tuple[float, float]:
        """Return the seconds that the processes' tasks spent on a processor, and waiting for one."""
        roots = list(processes)
        found = accounts_of(descendants(roots)) if roots else None
        if not found:
            return 0.0, 0.0
        before = self.accounts or {}
        pairs = [(before.get(task, _NONE), account) for task, account in found.items()]
        ran = sum(account.ran - first.ran for first, account in pairs)
        return ran, sum(account.queued - first.queued for first, account in pairs)
