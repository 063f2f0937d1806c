"""Motions controlled by the wrist's force sensor: stop on contact, push with a force.

Both steer the tool's velocity at every tick. In the field: guarded motion, and control by an *admittance*,
velocity = gain · missing force. The orientation stays.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from mutabot_cell.geometry import Array

from .online import JointSteps
from .trajectory import Motion

ACCELERATION = 1.0
"""With which the tool changes its velocity in these motions, m/s² (our choice): half of what it may."""
GAIN = 4e-4
"""Velocity per missing force, m/s per N (our choice). Pressed on a table, servos and contact give way by some
0.07 mm per N, so a missing force fades with a time constant of 0.17 s: slow beside sensor and servos."""
_THERE = 1e-5

Feel = Callable[[], Array]
"""Tells what the surroundings exert on the tool by the wrist's sensor: base frame, N, shape (3,)."""


class _Steered:
    """The tool under velocity control."""

    def __init__(self, steps: JointSteps, period: float) -> None:
        self._steps, self._period = steps, period
        self.start, self._rotation = steps.tool()
        self.position: Array = self.start.copy()
        self.velocity: Array = np.zeros(3)

    def go(self, wanted: Array) -> Motion:
        """Return the setpoints of one tick towards a velocity, m/s, shape (3,)."""
        change = wanted - self.velocity
        size, most = float(np.linalg.norm(change)), ACCELERATION * self._period
        if size > most:
            change = change * (most / size)
        velocity = self.velocity + change
        self.position = self.position + (self.velocity + velocity) * (self._period / 2)
        self.velocity = velocity
        return self._steps.towards(self.position, self._rotation, np.concatenate((velocity, np.zeros(3))))

    def is_at_rest(self) -> bool:
        """Return whether the tool is at rest."""
        return not self.velocity.any()


class UntilContact:
    """A straight motion that ends when something resists.

    Args:
        steps: the joints, at rest.
        shift: as far as the tool goes at most, m, shape (3,), base frame.
        speed: m/s.
        force: along the way that ends the motion, N.
        feel: see `Feel`.
        period: a control tick, s.

    Attributes:
        touched: whether something resisted.
    """

    def __init__(
        self, steps: JointSteps, shift: Array, speed: float, force: float, feel: Feel, period: float
    ) -> None:
        self._tool = _Steered(steps, period)
        self._length = float(np.linalg.norm(shift))
        self._direction: Array = shift / self._length
        self._speed, self._force, self._feel, self._period = speed, force, feel, period
        self.touched = False

    def tick(self) -> Motion | None:
        """Return the setpoints of the coming tick; see `OnlineMotion`."""
        self.touched = self.touched or float(-self._feel() @ self._direction) >= self._force
        left = self._length - float((self._tool.position - self._tool.start) @ self._direction)
        if self._tool.is_at_rest() and (self.touched or left < _THERE):
            return None
        if self.touched:
            return self._tool.go(np.zeros(3))
        now = float(self._tool.velocity @ self._direction)
        return self._tool.go(min(self._speed, _braking_speed(left, now, self._period)) * self._direction)


def _braking_speed(left: float, now: float, period: float) -> float:
    """Return the speed at the end of this tick from which the tool can still stop within `left` m, m/s."""
    change = ACCELERATION * period
    beyond = max(0.0, left - now * period / 2)
    return math.sqrt(2 * ACCELERATION * beyond + change**2 / 4) - change / 2


class Push:
    """A push with a force for some time, compliant along the given axes.

    Args:
        steps: the joints, at rest.
        forces: along the base frame's axes that the tool shall exert, N; None where it shall keep its place.
        speed: at most, along each axis, m/s.
        travel: ends the motion when the tool has gone so far, m.
        seconds: ends the motion otherwise.
        feel: see `Feel`.
        period: a control tick, s.
    """

    def __init__(
        self,
        steps: JointSteps,
        forces: Sequence[float | None],
        speed: float,
        travel: float,
        seconds: float,
        feel: Feel,
        period: float,
    ) -> None:
        self._tool = _Steered(steps, period)
        self._forces: Array = np.array([0.0 if force is None else force for force in forces])
        self._yields: Array = np.array([0.0 if force is None else 1.0 for force in forces])
        self._speed, self._travel, self._feel = speed, travel, feel
        self._left = round(seconds / period)

    def stop(self) -> None:
        """Bring the tool to rest from the coming tick on."""
        self._left = 0

    def tick(self) -> Motion | None:
        """Return the setpoints of the coming tick; see `OnlineMotion`."""
        self._left -= 1
        gone = float(np.linalg.norm(self._tool.position - self._tool.start))
        if self._left < 0 or gone >= self._travel:
            self._left = min(self._left, -1)
            return None if self._tool.is_at_rest() else self._tool.go(np.zeros(3))
        missing = self._forces + self._feel()
        wanted = np.clip(GAIN * missing, -self._speed, self._speed) * self._yields
        return self._tool.go(wanted)
