"""How much of the time that a process may take it has used, on a machine that others use as well.

Time in which its tasks stood in the queue for a processor is none that it has used. So a limit of wall clock
means on a busy machine what it means on a quiet one, as far as the kernel keeps account of that.
"""

from __future__ import annotations

from collections.abc import Iterable
from time import monotonic  # before a simulation takes over the clock

from mutabot.frozen import frozen

from .demand import Account, Accounts, accounts_of, below, children, is_crowded, shortage

#: a limit is extended to this many times its length at most
MOST = 10.0
#: the share of the time in the queue, and that in which processors were short, which make a time-out doubtful
_QUEUED, _SHORT = 0.1, 0.5
_NONE = Account(0.0, 0.0)


@frozen
class TimeUsed:
    """What there was when the time of a process began.

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
        """The time of these processes, and of those that they start, begins."""
        return cls(monotonic(), accounts_of(processes), shortage())

    def left(self, limit: float, processes: Iterable[int]) -> float:
        """Seconds until so many are used up, if the processes, and those below them, are not held up again.

        0 or less: they are, or ``MOST`` times as many have passed.
        """
        passed = monotonic() - self.began
        if passed >= MOST * limit:
            return 0.0
        ran, queued = self._had(processes)
        return limit - max(ran, passed - min(queued, passed))

    def hindrance(self, processes: Iterable[int] = ()) -> str | None:
        """Why nobody can say that the time was enough, in words; None if the machine was quiet enough."""
        passed = monotonic() - self.began
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
        """Seconds that all their tasks together were on a processor, and stood in the queue for one."""
        roots = list(processes)
        found = accounts_of(below(roots, children())) if roots else None
        if not found:
            return 0.0, 0.0
        before = self.accounts or {}
        pairs = [(before.get(task, _NONE), account) for task, account in found.items()]
        ran = sum(account.ran - first.ran for first, account in pairs)
        return ran, sum(account.queued - first.queued for first, account in pairs)
