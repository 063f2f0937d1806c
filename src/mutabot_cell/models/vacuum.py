"""The vacuum in a suction cup: the air drawn out by an ejector and the air leaking in."""

from __future__ import annotations

import math
from dataclasses import dataclass

ATMOSPHERE = 101325.0
"""Standard atmosphere, Pa."""
AIR_DENSITY = 1.2
"""Of air at 20 °C, kg/m³."""
DISCHARGE = 0.6
"""Of a sharp-edged opening: the share of Bernoulli's flow that passes (textbook value)."""


@dataclass(frozen=True, slots=True)
class Ejector:
    """A compressed-air vacuum generator, its valves and its hose.

    Its suction falls in a straight line from `flow` in free air to nothing at `limit`, as makers' curves do
    roughly.

    Attributes:
        flow: of free air, m³/s. Schmalz recommends 8.3 l/min for a cup of up to 60 mm on a tight surface.
        limit: vacuum that it reaches without a leak, Pa below the atmosphere; 85 % is usual.
        volume: of cup, hose and ejector, m³; 1 m of hose of 4 mm and a cup (our choice).
        vent: opening through which air comes back when it is switched off, m² (our choice).
    """

    flow: float = 8.3e-3 / 60
    limit: float = 85e3
    volume: float = 2e-5
    vent: float = 3e-6

    @property
    def time_constant(self) -> float:
        """The time constant with which a tight cup is evacuated, s."""
        return self.volume * self.limit / (ATMOSPHERE * self.flow)


class Vacuum:
    """The pressure in a cup, which follows from the mass of its air at constant temperature.

    Attributes:
        pressure: below the atmosphere, Pa.
    """

    def __init__(self, ejector: Ejector) -> None:
        self._ejector = ejector
        self.pressure = 0.0

    def advance(self, seconds: float, opening: float, *, is_on: bool) -> None:
        """Advance by some time.

        Air comes in through openings by Bernoulli's law, q = 0.6 · A · √(2p/ρ), which says too much of it, by
        up to two thirds, above half an atmosphere of vacuum. A step is implicit, so a wide opening is as
        stable as a narrow one.

        Args:
            seconds: how long.
            opening: area through which air comes in, m².
            is_on: whether the ejector draws; otherwise its vent is open.
        """
        ejector = self._ejector
        rise = seconds * ATMOSPHERE / ejector.volume
        drawn = ejector.flow if is_on else 0.0
        if not is_on:
            opening += ejector.vent
        # p + rise · (drawn · (1 - new / limit) - leak · √new) = new, a quadratic equation for √new
        square = 1.0 + rise * drawn / ejector.limit
        leak = rise * DISCHARGE * opening * math.sqrt(2.0 / AIR_DENSITY)
        root = math.sqrt(leak * leak + 4.0 * square * (self.pressure + rise * drawn)) - leak
        self.pressure = (root / (2.0 * square)) ** 2
