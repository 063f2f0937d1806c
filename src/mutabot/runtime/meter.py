"""Meters what a test uses: simulated time and memory, up to the limits that a mutant has."""

from __future__ import annotations

import resource
from dataclasses import dataclass, field

from mutabot.model.clocks import process_time


class TimeExceeded(BaseException):  # it is no error of the program's
    """A test took too much simulated time. Not an ``Exception``, so that no program handles it by mistake."""


@dataclass(slots=True)
class Meter:
    """A meter of what the running test has used so far.

    Attributes:
        limit: seconds of simulated time that it may take; None for any.
        spare: seconds of processor time within which it has not exceeded that: a loop whose end is near may
            ask a simulated clock many times in a moment.
        operations: intercepted calls so far.
        started, now: simulated time at the test's first tick and at its last one, s; None before.
        used: simulated time that earlier clocks of the same test counted, s.
        exceeded: description of the limit that was exceeded.
        guarded: which command a guard kept from the robot, and why; None if none did.
        began: processor time of this process when it began with the test, s.
    """

    limit: float | None = None
    spare: float = 0.0
    operations: int = 0
    started: float | None = None
    now: float | None = None
    used: float = 0.0
    exceeded: str | None = None
    guarded: str | None = None
    began: float = field(default_factory=process_time)

    def continue_in_copy(self) -> None:
        """Restart the count of processor time in a process that was just forked."""
        self.began = process_time()

    def tick(self, time: float) -> None:
        """Set simulated time to ``time`` (s). Raises TimeExceeded beyond the limit."""
        if self.started is None or self.now is None:
            self.started = time
        elif time < self.now:  # a new simulation began in the same test
            self.used += self.now - self.started
            self.started = time
        self._reach(time)

    def advance(self, seconds: float) -> None:
        """Advance simulated time by some seconds. Raises TimeExceeded beyond the limit."""
        if self.started is None or self.now is None:
            self.started = self.now = 0.0
        self._reach(self.now + seconds)

    def _reach(self, time: float) -> None:
        self.now = time
        if self.limit is not None and (self.simulated or 0.0) > self.limit:
            self._exceed(self.limit)

    @property
    def simulated(self) -> float | None:
        """Simulated seconds so far; None without a clock."""
        if self.started is None or self.now is None:
            return None
        return self.used + self.now - self.started

    def _exceed(self, limit: float) -> None:
        if process_time() - self.began > self.spare:
            self.exceeded = self.exceeded or f"more than {limit:.6g} s of simulated time"
            raise TimeExceeded(self.exceeded)


def limit_memory(limit: int) -> None:
    """Let allocations beyond ``limit`` bytes of address space fail in this process."""
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    allowed = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
    resource.setrlimit(resource.RLIMIT_AS, (allowed, hard))
