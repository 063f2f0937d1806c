"""Sensor noise: one generator per sensor, so that a further reading of one does not shift the others."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

STANDARD_DEVIATIONS = {
    "joint angle": 0.005,  # deg; makes 0.1 mm and 0.015 deg at the tool
    "box position": 0.0005,  # m
    "distance": 0.001,  # m
    "opening": 0.0001,  # m
    "force": 0.1,  # N; data sheet of Robotiq's FT 300-S
    "torque": 0.005,  # Nm; likewise
    "vacuum": 200.0,  # Pa; 0.2 % of the range of usual vacuum sensors
}
"""Standard deviation of each sensor's normal noise (our choice, typical of such devices)."""


class SeededNoise:
    """Normal noise derived from a seed; every name has its own stream.

    Args:
        seed: of the round.
        enabled: False makes every reading exact.
        scope: before the names of all streams, so that each robot has its own.

    Attributes:
        errors: by the name of a sensor, what it makes of each true value beside its noise; none at first.
    """

    def __init__(self, seed: int, *, enabled: bool = True, scope: str = "") -> None:
        self._seed, self._scope = seed, scope
        self._enabled = enabled
        self._streams: dict[str, random.Random] = {}
        self.errors: dict[str, Callable[[float], float]] = {}

    def stream(self, name: str) -> random.Random:
        """Return the generator for `name`; also used for values drawn once per round."""
        if name not in self._streams:
            self._streams[name] = random.Random(f"{self._seed}/{self._scope}{name}")
        return self._streams[name]

    def add(self, name: str, value: float) -> float:
        """Return `value` plus noise of the sensor `name`, in the sensor's unit."""
        if self.errors and name in self.errors:
            value = self.errors[name](value)
        if not self._enabled:
            return value
        return value + self.stream(name).gauss(0.0, STANDARD_DEVIATIONS[name])

    @property
    def is_enabled(self) -> bool:
        """Whether sensors have noise."""
        return self._enabled

    def field(self, name: str, deviation: float, count: int) -> NDArray[np.float64]:
        """Return `count` normal draws with mean 0, shape (count,); zeros with sensor noise off."""
        if not self._enabled:
            return np.zeros(count)
        draws = np.random.default_rng(self.stream(name).getrandbits(128))
        return draws.normal(0.0, deviation, count)

    def bounded(self, name: str, deviation: float) -> float:
        """Return a normal draw with mean 0, cut at two standard deviations; also with sensor noise off."""
        while True:
            draw = self.stream(name).gauss(0.0, deviation)
            if math.fabs(draw) <= 2 * deviation:
                return draw
