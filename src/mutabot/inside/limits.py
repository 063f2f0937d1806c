"""What a test may use: operations, simulated time, memory."""

from __future__ import annotations

import resource
from dataclasses import dataclass

from mutabot.border.job import Budget


class BudgetExceeded(BaseException):  # it is no error of the program's
    """A test used more than its budget. Not an ``Exception``, so that no program handles it by mistake."""


@dataclass(slots=True)
class Meter:
    """What the running test has used so far.

    Attributes:
        budget: its limits.
        operations: intercepted calls so far.
        started, now: simulated time at the test's first tick and at its last one, s; None before.
        used: simulated time that earlier clocks of the same test counted, s.
        exceeded: the first limit that was exceeded, in words.
    """

    budget: Budget
    operations: int = 0
    started: float | None = None
    now: float | None = None
    used: float = 0.0
    exceeded: str | None = None

    def count(self) -> None:
        """One more operation. Raises BudgetExceeded beyond the limit."""
        self.operations += 1
        limit = self.budget.operations
        if limit is not None and self.operations > limit:
            self._exceed(f"more than {limit} operations")

    def tick(self, time: float) -> None:
        """The simulation has advanced to ``time`` (s). Raises BudgetExceeded beyond the limit."""
        if self.started is None or self.now is None:
            self.started = time
        elif time < self.now:  # a new simulation began in the same test
            self.used += self.now - self.started
            self.started = time
        self._reach(time)

    def advance(self, seconds: float) -> None:
        """The simulation has advanced by a step (s). Raises BudgetExceeded beyond the limit."""
        if self.started is None or self.now is None:
            self.started = self.now = 0.0
        self._reach(self.now + seconds)

    def _reach(self, time: float) -> None:
        self.now = time
        limit = self.budget.simulated
        if limit is not None and (self.simulated or 0.0) > limit:
            self._exceed(f"more than {limit:.6g} s of simulated time")

    @property
    def simulated(self) -> float | None:
        """Simulated seconds so far; None without a clock."""
        if self.started is None or self.now is None:
            return None
        return self.used + self.now - self.started

    def _exceed(self, text: str) -> None:
        self.exceeded = self.exceeded or text
        raise BudgetExceeded(text)


def limit_memory(limit: int) -> None:
    """Let allocations beyond ``limit`` bytes of address space fail in this process."""
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    allowed = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
    resource.setrlimit(resource.RLIMIT_AS, (allowed, hard))
