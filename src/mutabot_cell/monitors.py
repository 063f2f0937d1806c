"""Conditions that must hold at every control tick."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from .errors import ConditionBroken
from .lookahead import QuickCheck
from .simulation import Simulation
from .stretch import LONGEST

MonitoredValues = Callable[[], Mapping[str, object]]


@dataclass(frozen=True, slots=True, eq=False)
class Condition:
    """A condition that is monitored."""

    name: str
    holds: Callable[[], object]
    values: MonitoredValues


class Monitors:
    """Checks conditions, and remembers broken ones, so that a swallowed exception still fails the test."""

    def __init__(self, simulation: Simulation, values: MonitoredValues) -> None:
        self._simulation = simulation
        self._values = values
        self._watched: list[Condition] = []
        self.broken: list[ConditionBroken] = []
        simulation.after_tick.append(self._check)
        simulation.lookahead.add_check(self._check, QuickCheck(lambda: 1 if self._watched else LONGEST))

    def always(
        self, condition: Callable[[], object], name: str, values: MonitoredValues | None = None
    ) -> Condition:
        """Check `condition` from now on, at every tick. See `Cell.always`."""
        watched = Condition(name, condition, values or self._values)
        self._watched.append(watched)
        self._check()
        return watched

    def forget(self, condition: Condition) -> None:
        """Stop checking a condition."""
        if condition in self._watched:
            self._watched.remove(condition)

    def verify(self) -> None:
        """Raise the first condition that broke at any time, if one did."""
        if self.broken:
            raise self.broken[0]

    def _check(self) -> None:
        for condition in self._watched:
            if not condition.holds():
                error = ConditionBroken(
                    name=condition.name, time=self._simulation.time, values=condition.values()
                )
                self._watched.remove(condition)
                self.broken.append(error)
                raise error
