"""Light barriers, which detect anything between a lamp and its receiver."""

from __future__ import annotations

from collections.abc import Iterable

import mujoco
import numpy as np

from .errors import SensorError
from .geometry import Array
from .lookahead import QuickCheck
from .scene import LightBarrier
from .simulation import TICK, Simulation

SOLID = np.array([1, 0, 0, 0, 0, 0], dtype=np.uint8)
"""Groups of shapes that stop light: all but those that are only there to look at."""


class LightBarriers:
    """The light barriers of a cell. Each samples at its rate, and holds the result until the next sample."""

    def __init__(self, simulation: Simulation, barriers: Iterable[LightBarrier]) -> None:
        self._simulation = simulation
        self._barriers = {barrier.name: barrier for barrier in barriers}
        self._read: dict[str, tuple[int, bool]] = {}
        self._geom = np.zeros(1, dtype=np.int32)
        self._periods = {_period(barrier) for barrier in self._barriers.values()} - {1}
        if self._periods:  # the others look when they are asked
            simulation.after_tick.append(self._look)
            simulation.lookahead.add_check(self._look, QuickCheck(self._until))

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all light barriers."""
        return tuple(self._barriers)

    def true_state(self, name: str) -> bool:
        """Return whether something interrupts the beam of `name` at this moment; for checks."""
        return self._is_hit(self._barriers[name])

    def is_interrupted(self, name: str | None = None) -> bool:
        """Return whether something interrupts the beam, as last sampled; of the first one without a name.

        Raises:
            SensorError: there is no such light barrier.
        """
        if name is None and self._barriers:
            name = next(iter(self._barriers))
        if name not in self._barriers:
            known = ", ".join(self._barriers) or "none"
            raise SensorError(f"no light barrier named {name!r} in the cell; there are: {known}")
        ticks = self._simulation.ticks
        if name not in self._read or ticks >= self._read[name][0] + _period(self._barriers[name]):
            self._read[name] = ticks, self._is_hit(self._barriers[name])
        return self._read[name][1]

    def _until(self) -> int:
        """Return the number of control ticks until the next sample of any barrier."""
        return min(period - self._simulation.ticks % period for period in self._periods)

    def _look(self) -> None:
        for name, barrier in self._barriers.items():
            if self._simulation.ticks % _period(barrier) == 0:
                self._read[name] = self._simulation.ticks, self._is_hit(barrier)

    def _is_hit(self, barrier: LightBarrier) -> bool:
        start: Array = np.array(barrier.start)
        ray = np.array(barrier.end) - start
        found = mujoco.mj_ray(
            self._simulation.model, self._simulation.data, start, ray, SOLID, 1, -1, self._geom
        )
        return bool(0.0 <= found <= 1.0)


def _period(barrier: LightBarrier) -> int:
    """Return the number of control ticks between samples."""
    return max(1, round(1.0 / (barrier.rate * TICK)))
