"""The gripper as robot programs use it: a command, a force, and its measurements."""

from __future__ import annotations

import math

from mutabot_cell.models.effectors import Fingers
from mutabot_cell.models.noise import SeededNoise

from .curve import Curve
from .errors import BadArgument
from .geometry import Array
from .lookahead import InputPlan, QuickCheck
from .robot import Robot
from .simulation import TICK, Simulation
from .stretch import LONGEST, Stretch

_BLOCKED = 0.003
_STANDING = 0.004
_LONGEST_TICKS = 600
_SURE_TICKS = 3
"""How long the fingers must be blocked, or free, until the gripper reports it."""


class Gripper:
    """A parallel gripper. Position 0 is open, 1 is closed."""

    def __init__(
        self,
        simulation: Simulation,
        robot: Robot,
        fingers: Fingers,
        noise: SeededNoise,
        force: float | None,
        speed: float | None,
    ) -> None:
        self._simulation = simulation
        self._robot = robot
        self._fingers = fingers
        self._noise = noise
        self._servo = robot.fingers
        self._control = Curve(fingers.paths, fingers.controls)
        self._target = 0.0
        self._setpoint = 0.0
        self._holding = False
        self._other_ticks = 0
        self._read: tuple[int, float] = (-1, 0.0)
        self._planned: list[float] = []
        self._newtons, self._strength = 0.0, 1.0
        self.set_force(fingers.force if force is None else force)
        self.set_speed(fingers.speed if speed is None else speed)
        simulation.before_tick.append(self._drive)
        simulation.after_tick.append(self._detect)
        simulation.lookahead.plan_inputs(self._drive, InputPlan(self._write, self._keep))
        simulation.lookahead.add_check(self._detect, QuickCheck(lambda: LONGEST, passed=self._detect_in))

    def set_force(self, newtons: float) -> None:
        """Set the grip force at each pad, N; the 2F-85 has 20..235 N.

        Raises:
            BadArgument: outside that range.
        """
        low, high = self._fingers.force_range
        if not low <= newtons <= high:
            raise BadArgument(f"Expected {low} <= force <= {high} N but got force={newtons!r}")
        self._newtons = float(newtons)
        self._apply_force()

    def set_strength(self, strength: float) -> None:
        """Wear the gripper: it grips with this fraction of the force that it is set to, now and from now on.

        Its object detection goes by the motor's current, and knows no better.
        """
        self._strength = max(strength, 0.0)
        self._apply_force()

    def _apply_force(self) -> None:
        self._force = self._strength * self._newtons * self._fingers.force_ratio
        self._simulation.model.actuator_forcerange[self._servo] = (-self._force, self._force)

    def set_speed(self, metres_per_second: float) -> None:
        """Set the speed at which the opening changes, m/s; the 2F-85 has 0.020..0.150 m/s.

        Raises:
            BadArgument: outside that range.
        """
        low, high = self._fingers.speed_range
        if not low <= metres_per_second <= high:
            raise BadArgument(f"Expected {low} <= speed <= {high} m/s but got speed={metres_per_second!r}")
        self._speed = float(metres_per_second)

    def command(self, position: float, *, wait: bool = False) -> None:
        """Start moving the fingers to `position` (0 open .. 1 closed).

        The command returns at once, as the real gripper's does; the fingers move while time passes.

        Args:
            wait: let time pass until the fingers have arrived or are blocked.

        Raises:
            BadArgument: not a number in 0..1.
        """
        if not isinstance(position, (int, float)) or isinstance(position, bool) or not 0.0 <= position <= 1.0:
            raise BadArgument(f"Expected 0 <= position <= 1 but got position={position!r}")
        target = position * self._fingers.stroke
        if target != self._target:
            self._target = target
            # blocked fingers start from where they are, not from where they wanted to be
            self._setpoint = self._robot.closed_path()
        if wait:
            for _ in range(_LONGEST_TICKS):
                self._simulation.tick()
                if self._setpoint == self._target and self._stands():
                    break

    def commanded(self) -> float:
        """Return the last command, 0..1."""
        return self._target / self._fingers.stroke

    def opening(self) -> float:
        """Return the measured distance between the pads, m, with noise; one reading per tick."""
        ticks, reading = self._read
        if ticks != self._simulation.ticks:
            reading = self._noise.add("opening", self._fingers.stroke - self._robot.closed_path())
            self._read = self._simulation.ticks, reading
        return reading

    def holding(self) -> bool:
        """Return whether the fingers press and are blocked by something between them.

        Like the real gripper's object detection, it knows only its own position, speed and motor current, and
        changes its report when the new state has lasted for 30 ms.
        """
        return self._holding

    def _detect(self) -> None:
        path, speed, force = self._robot.finger_state()
        self._count(self._grips(path, speed, force))

    def _grips(self, path: float, speed: float, force: float) -> bool:
        """Return whether the fingers are blocked, press and do not move."""
        return (
            abs(self._target - path) > _BLOCKED and abs(force) > 0.9 * self._force and abs(speed) < _STANDING
        )

    def _count(self, grips: bool) -> None:
        if grips == self._holding:
            self._other_ticks = 0
            return
        self._other_ticks += 1
        if self._other_ticks == _SURE_TICKS:
            self._holding, self._other_ticks = not self._holding, 0

    def _stands(self) -> bool:
        return abs(self._robot.closing_speed()) < _STANDING

    def _drive(self) -> None:
        self._setpoint = self._next(self._setpoint)
        self._simulation.setpoints[:, self._servo] = self._input(self._setpoint)

    def _next(self, setpoint: float) -> float:
        """Return the setpoint one tick later."""
        missing = self._target - setpoint
        return setpoint + math.copysign(min(self._speed * TICK, abs(missing)), missing)

    def _input(self, setpoint: float) -> float:
        return self._control(setpoint)

    def _write(self, inputs: Array) -> int:
        """Write the setpoints of the coming ticks, as `_drive` does for one."""
        wanted, setpoint = inputs[:, :, self._servo], self._setpoint
        if setpoint == self._target:
            self._planned = [setpoint] * len(inputs)
            wanted[:] = self._input(setpoint)
            return len(inputs)
        self._planned = []
        for tick in wanted:
            setpoint = self._next(setpoint)
            self._planned.append(setpoint)
            tick[:] = self._input(setpoint)
        return len(inputs)

    def _keep(self, ticks: int) -> None:
        self._setpoint = self._planned[ticks - 1]

    def _detect_in(self, stretch: Stretch, ticks: int) -> None:
        """Detect a grip in each tick of a stretch, as `_detect` does for one."""
        for reading in stretch.readings[:ticks, self._robot.sensors].tolist():
            self._count(self._grips(*self._robot.finger_state_of(*reading)))
