"""The order in which ready threads and callbacks continue.

`first-in` takes what has become ready first: each run is the same. `random` draws from a seed. A program
whose outcome depends on the order fails under some seed, and fails again under the same.
"""

from __future__ import annotations

from random import Random
from typing import Protocol

#: the longest time in which a node of another process is discovered, with random schedules (ns)
DISCOVERY = 200_000_000
#: the longest time that a message is under way, with random schedules (ns)
TRANSIT = 2_000_000


class Schedule(Protocol):
    """Decides wherever the order is open."""

    def begin(self, test: str) -> None:
        """Begin a test: its random numbers depend on its name alone, so it can be replayed alone."""

    def choose(self, number: int) -> int:
        """Choose which of the ready threads continues."""

    def switches_here(self) -> bool:
        """Return whether the running thread lets others run at a place at which it need not."""

    def keeps(self, number: int) -> list[bool]:
        """Choose which of `number` ready entities a wait set reports now; at least one."""

    def discovery(self) -> int:
        """Return how long (ns) two endpoints in different contexts take to discover each other."""

    def transit(self) -> int:
        """Return how long (ns) a message is in transit."""


class FirstIn:
    """Runs what has become ready first; nothing takes time."""

    def begin(self, test: str) -> None:
        """Do nothing: this order draws no random numbers."""

    def choose(self, number: int) -> int:
        return 0

    def switches_here(self) -> bool:
        return False

    def keeps(self, number: int) -> list[bool]:
        return [True] * number

    def discovery(self) -> int:
        return 0

    def transit(self) -> int:
        return 0


class RandomOrder:
    """A random order, drawn from a seed."""

    def __init__(self, seed: int) -> None:
        self.seed = seed
        self._random = Random(seed)

    def begin(self, test: str) -> None:
        self._random = Random(f"{self.seed} {test}")

    def choose(self, number: int) -> int:
        return self._random.randrange(number)

    def switches_here(self) -> bool:
        return self._random.random() < 0.1

    def keeps(self, number: int) -> list[bool]:
        kept = [self._random.random() < 0.5 for _ in range(number)]
        if not any(kept):
            kept[self._random.randrange(number)] = True
        return kept

    def discovery(self) -> int:
        return self._random.randrange(DISCOVERY)

    def transit(self) -> int:
        return self._random.randrange(TRANSIT)


def schedule_named(name: str, seed: int = 0) -> Schedule:
    """Return the schedule with a name: `first-in` or `random`."""
    if name == "first-in":
        return FirstIn()
    if name == "random":
        return RandomOrder(seed)
    raise ValueError(f"no schedule is named {name!r}; there are: first-in, random")
