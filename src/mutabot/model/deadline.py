"""Time limits for a process and all below it, and whether they are used up.

A process that computes is ended by its processor time, which other processes on the machine do not change.
One that waits uses none: the wall clock ends it, without the time in which it wanted a processor and had
none. The time that a host takes from a virtual machine is not counted. So a process that has used most of its
processor time is given up to twice the wall clock's limit to use the rest.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from mutabot.frozen import frozen
from mutabot.model.clocks import monotonic
from mutabot.model.process_time import MOST, TimeUsed, descendants

#: seconds after which the accounts of a process are read for the first time, which takes milliseconds: most
#: tests are over by then
_FIRST = 0.5
#: how many times its limit of wall clock a process may take that computes: see above
_COMPUTING = 2.0
#: seconds between two looks at least
_LEAST = 0.2


@frozen
class Limit:
    """The limits of a process: wall-clock and processor time.

    Attributes:
        wall: seconds by the clock on the wall.
        processor: seconds on processors, of all its tasks and those of the processes below it together; None
            for no limit.
    """

    wall: float
    processor: float | None = None

    def with_more(self, wall: float, processor: float) -> Limit:
        """Return a deadline that is later by this many seconds."""
        return Limit(self.wall + wall, None if self.processor is None else self.processor + processor)

    @property
    def least(self) -> float:
        """Seconds that pass at least before a process exceeds it, unless it uses several processors."""
        return self.wall if self.processor is None else min(self.wall, self.processor)


@dataclass(slots=True)
class Deadline:
    """The time that a process has for a test, or until its first one begins.

    Attributes:
        limit: what it may take.
        is_counted: whether the process has just begun, or was looked at before. What it and those below it
            have had by the first look does not count otherwise.
        used: what there was when its time began.
        until: moment (``time.monotonic``) at which to look (again).
        by_processor: whether its processor time is used up.
        hindered: the reason to doubt that it had enough time by the wall clock, for the user, or None.
        is_starved: whether it is to be ended although it has not had its time, as it would take too long.
    """

    limit: Limit
    is_counted: bool = False
    used: TimeUsed = field(default_factory=TimeUsed.from_now)
    by_processor: bool = False
    hindered: str | None = None
    is_starved: bool = False
    until: float = field(init=False)

    def __post_init__(self) -> None:
        least = self.limit.least
        self.until = self.used.began + (least if self.is_counted else min(_FIRST, least))

    def is_over(self, process: int) -> bool:
        """Return whether a process has used up its time. Call it at ``until``, which it updates."""
        if not self.is_counted:
            self.is_counted, self.used = True, TimeUsed.from_now(descendants([process]))
            self.until = self.used.began + self.limit.least
            return False
        wall, processor = self.used.remaining(self.limit.wall, self.limit.processor, [process])
        left = wall if processor is None else self._left(wall, processor)
        if left > 0:
            self.until = monotonic() + max(left, _LEAST)
            return False
        self.by_processor = processor is not None and processor <= 0
        if not self.by_processor:
            self.hindered = self.used.hindrance([process])
            self.is_starved = self.used.age >= MOST * self.limit.wall
        return True

    def _left(self, wall: float, processor: float) -> float:
        """Return the seconds left in both budgets, wall-clock and processor time."""
        most = self.limit.processor or 0.0
        computes = processor < most / 2 and self.used.age < min(_COMPUTING, MOST) * self.limit.wall
        return processor if computes else min(wall, processor)

    def overdue(self, test: str | None) -> str:
        """Return a text that names the exceeded limit; without a ``test``, that before the first test."""
        of, seconds = "wall clock", self.limit.wall
        if self.by_processor and self.limit.processor is not None:
            of, seconds = "processor time", self.limit.processor
        if test:
            return f"no end after {seconds:.0f} s of {of}"
        return f"no test begun or finished within {seconds:.0f} s of {of}"
