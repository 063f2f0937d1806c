"""How far a stage of a campaign is, and how long the rest will take at the pace so far."""

from __future__ import annotations

import time
from collections.abc import Callable

#: part of a stage after which the time left is worth telling: the first steps say little about the others
_TELLING = 0.1


class Pace:
    """The steps of one stage.

    Args:
        total: how many there are; None if that is not known.
        clock: seconds that count.

    Attributes:
        total, done: steps.
    """

    def __init__(self, total: int | None = None, clock: Callable[[], float] = time.monotonic) -> None:
        self.total, self.done = total, 0
        self._clock = clock
        self._began = clock()

    def advance(self) -> None:
        """One more is done."""
        self.done += 1

    @property
    def is_done(self) -> bool:
        """Whether all are, if it is known how many there are."""
        return self.total is not None and self.done >= self.total

    @property
    def spent(self) -> float:
        """Seconds since it began."""
        return self._clock() - self._began

    @property
    def left(self) -> float | None:
        """Seconds that the rest will take; None as long as too little is known to tell."""
        if self.total is None or self.done == 0 or self.done < _TELLING * self.total:
            return None
        return self.spent / self.done * max(0, self.total - self.done)
