"""A conveyor belt: its drive, its encoder, and the surface that carries parts."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace

import numpy as np

from mutabot_cell.models.noise import SeededNoise

from .errors import BadArgument, SensorError
from .geometry import Array
from .scene import Belt
from .simulation import TICK, Simulation
from .waking import PartsOnBelt

_KEPT_TICKS = 500
_SPEED_WINDOW = 0.1


class ConveyorBelt:
    """A belt as a program uses it. Positions are metres of belt since the cell was made.

    The physics knows the belt as a surface velocity of a fixture that stays where it is: friction alone
    carries what lies on it.

    Attributes:
        name: of the fixture whose surface moves.
        direction: unit vector of positive speed, shape (3,), world frame, as it was when the cell was made:
            the controller does not know of a conveyor that is moved afterwards.
        drive_factor, encoder_factor: what part of the commanded speed the drive gives, and of the travel the
            encoder reads; 1 for a belt without an error.
    """

    def __init__(self, simulation: Simulation, name: str, belt: Belt, noise: SeededNoise) -> None:
        self.name = name
        self._simulation = simulation
        self._belt = belt
        self._random = noise.stream(f"speed of {name}")
        self._geom = simulation.model.geom(name).id
        along = np.array(belt.direction, dtype=float)
        self._along: Array = along / np.linalg.norm(along)
        frame = simulation.data.geom_xmat[self._geom].reshape(3, 3)
        self.direction: Array = frame @ self._along
        self.drive_factor = self.encoder_factor = 1.0
        self._commanded = 0.0
        self._drive_speed = 0.0
        self._wander = 0.0
        self._speed = 0.0
        self._moving = False
        self._awake = PartsOnBelt(simulation, self._geom)
        # travel at each tick's beginning, the last one of tick `_known`
        self._past = deque([0.0], maxlen=_KEPT_TICKS)
        self._known = simulation.ticks
        simulation.travels[name] = self.true_position

    def run(self, speed: float) -> None:
        """Bring the belt to `speed` (m/s; negative is backwards). Return at once; the drive accelerates.

        Raises:
            BadArgument: not a number within the drive's limits.
        """
        limit = self._belt.speed_limit
        if not isinstance(speed, (int, float)) or isinstance(speed, bool) or not abs(speed) <= limit:
            raise BadArgument(f"Expected -{limit} <= speed <= {limit} m/s but got speed={speed!r}")
        self._commanded = float(speed)
        if not self._moving and speed:
            self._simulation.model.flg_surfacevel = True
            self._moving = True
            self._catch_up()
            self._simulation.before_tick.append(self._drive)

    def stop(self) -> None:
        """Bring the belt to rest. Return at once; the drive decelerates."""
        self.run(0.0)

    def commanded(self) -> float:
        """Return the last commanded speed, m/s."""
        return self._commanded

    def position(self, at: float | None = None) -> float:
        """Return what the encoder reads, m, in whole counts.

        Args:
            at: simulated time, s, of a reading that was latched in the past 5 s, as a trigger of a camera or
                a light barrier does; now by default.

        Raises:
            SensorError: `at` is in the future or too long ago.
        """
        count = self._belt.resolution
        return math.floor(self.encoder_factor * self._travelled(at) / count + 1e-6) * count

    def set_jitter(self, deviation: float) -> None:
        """Set the standard deviation of the speed from now on, as a fraction of the commanded speed."""
        self._belt = replace(self._belt, jitter=deviation)

    def speed(self) -> float:
        """Return the mean speed over the last 0.1 s by the encoder, m/s."""
        now = self._simulation.time
        before = max(now - _SPEED_WINDOW, (self._known - len(self._past) + 1) * TICK)
        return (self.position() - self.position(before)) / (now - before) if now > before else 0.0

    def true_position(self) -> float:
        """Return the exact travel, m; for checks."""
        return self._travelled(None)

    def true_speed(self) -> float:
        """Return the exact speed of the surface, m/s; for checks."""
        return self._speed

    def _travelled(self, at: float | None) -> float:
        """Return the exact travel at a time, s; now by default. Within a tick the belt runs evenly."""
        self._catch_up()
        now = self._simulation.ticks
        tick = float(now) if at is None else at / TICK
        oldest = self._known - len(self._past) + 1
        if not oldest - 1e-6 <= tick <= now + 1e-6:
            raise SensorError(
                f"the encoder of {self.name!r} keeps what it read from t={oldest * TICK:.2f} to "
                f"{now * TICK:.2f} s, and was asked for t={at} s"
            )
        index = min(max(math.floor(tick), oldest), now)
        part = tick - index
        begin = self._past[index - oldest]
        end = self._past[index - oldest + 1] if index < self._known else begin
        return begin + part * (end - begin)

    def _catch_up(self) -> None:
        """Account for the time in which the belt stood since it was last driven."""
        missing = self._simulation.ticks - self._known
        if missing > 0:
            self._past.extend([self._past[-1]] * min(missing, _KEPT_TICKS))
            self._known += missing

    def _drive(self) -> None:
        change = self._belt.acceleration * TICK
        missing = self._commanded - self._drive_speed
        self._drive_speed += math.copysign(min(change, abs(missing)), missing)
        self._speed = self.drive_factor * self._drive_speed * (1.0 + self._wandered())
        self._simulation.model.geom_surfacevel[self._geom, :3] = self._speed * self._along
        self._past.append(self._past[-1] + self._speed * TICK)
        self._known += 1
        self._awake.keep()
        if not self._drive_speed and not self._commanded:
            self._moving = False
            self._awake.let_sleep()
            # a list of its own: the one that is being gone through stays as it is
            simulation = self._simulation
            simulation.before_tick = [hook for hook in simulation.before_tick if hook != self._drive]

    def _wandered(self) -> float:
        """Return the speed's relative error: an Ornstein-Uhlenbeck process, stepped exactly."""
        deviation = self._belt.jitter
        if not deviation or not self._drive_speed:
            return 0.0
        kept = math.exp(-TICK / self._belt.jitter_time)
        self._wander = kept * self._wander + self._random.gauss(0.0, deviation * math.sqrt(1.0 - kept**2))
        return self._wander
