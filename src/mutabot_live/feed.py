"""What browsers are told as it happens: the last state, and notes.

Nobody has a queue. Who asks gets what is new since he last asked, and a state only once it is the last: a
browser that is slow misses states in between, and holds up nobody.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

#: notes that are kept for those who come later
_NOTES = 100
#: browsers at a time
_MOST = 32


@dataclass(frozen=True, slots=True)
class Event:
    """Something that browsers are told.

    Attributes:
        number: later events have higher ones.
        kind: ``state`` or ``note``.
        data: what JSON can hold.
    """

    number: int
    kind: str
    data: Any


class Feed:
    """Events of one campaign; any thread may add and read."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._number = 0
        self._state: Event | None = None
        self._notes: deque[Event] = deque(maxlen=_NOTES)
        self._readers = 0
        self._left = float("-inf")
        self._is_closed = False

    def put(self, state: Mapping[str, Any]) -> None:
        """The state is another one now."""
        with self._changed:
            self._state = self._next("state", dict(state))
            self._changed.notify_all()

    def note(self, text: str) -> None:
        """Something the user should know."""
        with self._changed:
            self._notes.append(self._next("note", text))
            self._changed.notify_all()

    def close(self) -> None:
        """Nothing more will come."""
        with self._changed:
            self._is_closed = True
            self._changed.notify_all()

    def after(self, number: int, seconds: float) -> list[Event]:
        """What came after an event, at once or within so many seconds. A number of no event is the first."""
        with self._changed:
            if number > self._number:  # it is from another feed
                number = 0
            self._changed.wait_for(lambda: self._is_closed or self._since(number), seconds)
            return self._since(number)

    @property
    def is_closed(self) -> bool:
        """Whether nothing more will come."""
        return self._is_closed

    @contextmanager
    def reader(self) -> Iterator[bool]:
        """While a browser listens; False if there are too many."""
        with self._changed:
            is_free = self._readers < _MOST
            self._readers += is_free
        try:
            yield is_free
        finally:
            with self._changed:
                self._readers -= is_free
                self._left = time.monotonic()

    def is_listened_to(self, seconds: float) -> bool:
        """Whether a browser listens, or did within so many seconds: it may only load its page again."""
        with self._changed:
            return self._readers > 0 or time.monotonic() - self._left < seconds

    def _next(self, kind: str, data: Any) -> Event:
        self._number += 1
        return Event(self._number, kind, data)

    def _since(self, number: int) -> list[Event]:
        last = [self._state] if self._state is not None else []
        return sorted((one for one in [*self._notes, *last] if one.number > number), key=_number)


def _number(event: Event) -> int:
    return event.number
