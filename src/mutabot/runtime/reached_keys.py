"""Track which keys the running test reaches: simulated time, calls, and their counts.

Only keys that are awaited are looked for: by the mutants of a fork parent, or by the fault of this process.
To both they are reported in the same way, so that a fault begins in a fork where it does in a process of its
own.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable

from mutabot.model.activation import CALL, NTH, TIME, Activation, Key, of_kind


class ReachedKeys:
    """The keys that are awaited in this process.

    Args:
        on_reach: called with the keys that are reached at once, and a call's number among those of its site.
        on_first_tick: called when the clock begins in a test.

    Attributes:
        asks_calls: whether a call is awaited.
    """

    def __init__(
        self, on_reach: Callable[[list[Key], int | None], None], on_first_tick: Callable[[], None]
    ) -> None:
        self._on_reach, self._on_first_tick = on_reach, on_first_tick
        self._times: tuple[float, ...] = ()
        self._due: list[float] = []
        self._counted: frozenset[Key] = frozenset()
        self._counts: Counter[Key] = Counter()
        self._has_ticked = False
        self.asks_calls = False
        self._passed = float("-inf")  # the last moment that was reported in this test

    def watch(self, keys: Iterable[Key]) -> None:
        """Watch for these keys from now on."""
        keys = list(keys)
        self._counted = frozenset(key[2:] for key in of_kind(keys, NTH))
        every = [*keys, *self._counted]
        self._times = tuple(sorted({key[1] for key in of_kind(every, TIME)}))
        self._due = [time for time in self._times if time > self._passed]
        self.asks_calls = bool(of_kind(every, CALL))

    def start_test(self) -> None:
        """Begin a test."""
        self._due, self._has_ticked = list(self._times), False
        self._passed = float("-inf")
        self._counts.clear()

    def tick(self, seconds: float) -> None:
        """Note the simulated time of the running test, in seconds."""
        if not self._has_ticked:
            self._has_ticked = True
            self._on_first_tick()
        while self._due and self._due[0] <= seconds:
            self._passed = self._due.pop(0)
            self._reach(Activation.at_time(self._passed))

    def call(self, key: Key, number: int) -> None:
        """Note a call that the program is about to make, by its number among those of its site."""
        self._reach(key, number)

    def _reach(self, key: Key, number: int | None = None) -> None:
        keys = [key]
        if self._counted and key in self._counted:
            self._counts[key] += 1
            keys.append(Activation.nth(self._counts[key], key))
        self._on_reach(keys, number)
