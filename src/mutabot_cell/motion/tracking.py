"""Conveyor tracking: tool poses in a frame that moves with a belt.

The field's names: the belt's *encoder* gives its position, the controller estimates from it where the belt
will be a tick later, *synchronises* the tool with it under the tool's limits, and superimposes the program's
straight moves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np
import ruckig

from mutabot_cell.geometry import Array
from mutabot_cell.models.limits import JointLimits, ToolLimits

from .line import Line
from .online import JointSteps
from .trajectory import Motion, Spline, time_law

FILTER_TIME = 0.05
"""Time constant of the filter that estimates the belt's motion from whole encoder counts, s (our choice)."""
_SHARE = 0.5
"""Part of the tool's acceleration and jerk limits that following has, and that a superimposed move has."""
_SAFETY = 0.9
_CHECKS = 41
_SLOWER = 1.02
"""Planning a move ends when the joints' limits lengthen it by less than this factor."""
_SYNCHRONOUS = 2e-4
_SYNCHRONOUS_SPEED = 5e-3


class BeltEstimate:
    """The estimated position, speed and acceleration of a belt from its encoder's counts.

    A critically damped g-h-k filter (fading memory): even speed and even acceleration are followed without an
    error; a change of acceleration is known after some `FILTER_TIME`.

    Args:
        position: the encoder's reading, m.
        speed: a first guess, m/s.
        period: between readings, s.
    """

    def __init__(self, position: float, speed: float, period: float) -> None:
        self.position, self.speed, self.acceleration = position, speed, 0.0
        self._period = period
        kept = math.exp(-period / FILTER_TIME)
        self._g = 1.0 - kept**3
        self._h = 1.5 * (1.0 - kept) ** 2 * (1.0 + kept) / period
        self._k = (1.0 - kept) ** 3 / period**2

    def update(self, reading: float) -> None:
        """Process the next reading, one period after the last."""
        period = self._period
        self.position += (self.speed + self.acceleration * period / 2) * period
        self.speed += self.acceleration * period
        surprise = reading - self.position
        self.position += self._g * surprise
        self.speed += self._h * surprise
        self.acceleration += self._k * surprise


class Follower:
    """A coordinate that follows a moving target within limits of speed, acceleration and jerk.

    In the target's own frame the time-optimal way to it (by ruckig, anew at every tick) is one to rest.

    Attributes:
        position, speed, acceleration: now, in m and s.
    """

    def __init__(self, position: float, period: float, limits: ToolLimits) -> None:
        self._fastest = limits.speed
        self.position, self.speed, self.acceleration = position, 0.0, 0.0
        self._period = period
        self._law = ruckig.Ruckig(1, period)
        self._request = ruckig.InputParameter(1)
        self._request.max_acceleration = [limits.acceleration * _SHARE]
        self._jerk = limits.jerk * _SHARE
        self._request.target_position, self._request.target_velocity = [0.0], [0.0]
        self._answer = ruckig.OutputParameter(1)

    def follow(self, target: float, speed: float, acceleration: float) -> None:
        """Continue for one period towards a target, given its position, speed and acceleration now."""
        request = self._request
        request.control_interface = ruckig.ControlInterface.Position
        request.current_position = [self.position - target]
        request.current_velocity = [self.speed - speed]
        request.max_velocity = [self._fastest - speed]
        request.min_velocity = [-self._fastest - speed]
        self.acceleration -= acceleration
        self._go_on()
        self.position += target + (speed + acceleration * self._period / 2) * self._period
        self.speed += speed + acceleration * self._period
        self.acceleration += acceleration

    def brake(self) -> None:
        """Continue for one period towards rest."""
        request = self._request
        request.control_interface = ruckig.ControlInterface.Velocity
        request.current_position, request.current_velocity = [self.position], [self.speed]
        if self._go_on() == ruckig.Result.Finished:
            self.speed = self.acceleration = 0.0

    @property
    def is_at_rest(self) -> bool:
        """Whether the coordinate is at rest."""
        return self.speed == 0.0 and self.acceleration == 0.0

    def _go_on(self) -> ruckig.Result:
        self._request.current_acceleration = [self.acceleration]
        self._request.max_jerk = [self._jerk]
        time_law(self._law, self._request)
        result = self._law.update(self._request, self._answer)
        self.position, self.speed = self._answer.new_position[0], self._answer.new_velocity[0]
        self.acceleration = self._answer.new_acceleration[0]
        return result


class TrackedBelt(Protocol):
    """The interface of a belt for tracking, as of `mutabot_cell.belt.ConveyorBelt`.

    Attributes:
        direction: unit vector of positive speed, shape (3,), world frame.
    """

    direction: Array

    def position(self) -> float:
        """Return the encoder's reading, m."""
        ...

    def speed(self) -> float:
        """Return the speed by the encoder, m/s."""
        ...


class Tracking:
    """The tool's poses in a frame that moves with a belt, and straight moves in that frame.

    In that frame a thing on the belt is always where it was when the encoder read `since`.

    Args:
        steps: the joints, at rest.
        belt: to follow.
        along: the belt's direction in the base frame, shape (3,).
        since: m, of the encoder.
        period: a control tick, s.
        limits: of the tool.
    """

    def __init__(
        self,
        steps: JointSteps,
        belt: TrackedBelt,
        along: Array,
        since: float,
        period: float,
        limits: ToolLimits,
    ) -> None:
        self._steps, self._belt, self._along, self._since = steps, belt, along, since
        self._period, self._limits = period, limits
        self._estimate = BeltEstimate(belt.position() - belt.speed() * period, belt.speed(), period)
        self._offset = Follower(belt.position() - since, period, limits)
        position, rotation = steps.tool()
        self._place: Array = position - self._offset.position * along
        self._rotation = rotation
        self._move: LineLaw | None = None
        self._ending = False

    @property
    def is_synchronous(self) -> bool:
        """Whether the tool moves with the belt, as far as the encoder shows."""
        expected = self._estimate.position + self._estimate.speed * self._period  # as the setpoint: a tick on
        behind = expected - self._since - self._offset.position
        slower = self._estimate.speed - self._offset.speed
        return abs(behind) < _SYNCHRONOUS and abs(slower) < _SYNCHRONOUS_SPEED

    @property
    def is_moving(self) -> bool:
        """Whether a move in the belt's frame is in progress."""
        return self._move is not None

    def pose(self) -> tuple[Array, Array]:
        """Return the commanded position, shape (3,), m, and rotation, shape (3, 3), in the belt's frame."""
        return self._place.copy(), self._rotation.copy()

    def move(self, line: Line, speed: float, follow: Callable[[Line], Array]) -> None:
        """Begin a straight move in the belt's frame.

        Args:
            speed: part of the tool's speed limits, 0..1.
            follow: gives joint angles along a line in the base frame; raises what refuses it.
        """
        law = LineLaw(line, speed, abs(self._estimate.speed), self._period, self._limits)
        while True:
            duration = law.duration
            law.slow_down(Spline(follow(self._line_for_belt(line, duration))), self._steps.limits)
            if law.duration < duration * _SLOWER:
                break
        self._move = law

    def _line_for_belt(self, line: Line, duration: float) -> Line:
        """Return the line in the base frame for a belt that keeps its speed."""
        begin = line.start + self._offset.position * self._along
        return Line(
            begin, line.rotation, line.shift + self._estimate.speed * duration * self._along, line.turn
        )

    def stop_move(self) -> None:
        """Let the present move come to rest on its line; the tool still follows the belt."""
        if self._move is not None:
            self._move.stop()

    def end(self) -> None:
        """Bring the tool to rest in the base frame and end."""
        self._ending = True

    def tick(self) -> Motion | None:
        """Return the setpoints of the coming tick; see `OnlineMotion`."""
        if self._ending and self._offset.is_at_rest and self._move is None:
            return None
        self._estimate.update(self._belt.position())
        if self._ending:
            self._offset.brake()
        else:
            belt = self._estimate
            self._offset.follow(belt.position - self._since, belt.speed, belt.acceleration)
        along = self._along
        velocity = np.concatenate((self._offset.speed * along, np.zeros(3)))
        if self._move is not None:
            self._place, self._rotation, own = self._move.tick()
            velocity += own
            if self._move.is_done:
                self._move = None
        return self._steps.towards(self._place + self._offset.position * along, self._rotation, velocity)


class LineLaw:
    """The motion along a line, tick by tick, from rest to rest.

    Args:
        line: in whatever frame.
        speed: part of the tool's speed limits, 0..1.
        taken: speed of the frame itself, which is taken off the tool's limit, m/s.
        period: a control tick, s.
        limits: of the tool.
    """

    def __init__(self, line: Line, speed: float, taken: float, period: float, limits: ToolLimits) -> None:
        self._line = line
        self._law = ruckig.Ruckig(1, period)
        self._request = ruckig.InputParameter(1)
        self._answer = ruckig.OutputParameter(1)
        length, angle = max(line.length, 1e-9), max(line.angle, 1e-9)
        shift = min(limits.speed * speed, limits.speed - taken)
        request = self._request
        request.max_velocity = [min(shift / length, limits.turn_speed * speed / angle)]
        request.max_acceleration = [
            _SHARE * min(limits.acceleration / length, limits.turn_acceleration / angle)
        ]
        request.max_jerk = [_SHARE * min(limits.jerk / length, limits.turn_jerk / angle)]
        request.target_position = [1.0]
        self.duration = self._duration()
        self.is_done = False

    def _duration(self) -> float:
        return float(time_law(self._law, self._request).duration)

    def slow_down(self, joints: Spline, limits: JointLimits) -> None:
        """Slow down along the whole line where the joints would be too fast."""
        fractions = np.linspace(0.0, 1.0, _CHECKS)
        slope, bend = np.abs(joints.slope(fractions)), np.abs(joints.bend(fractions))
        speed, acceleration = np.array(limits.speed), np.array(limits.acceleration)
        rate = min(_least(speed, slope), math.sqrt(_SHARE * _least(acceleration, bend)))
        request = self._request
        request.max_velocity = [min(request.max_velocity[0], _SAFETY * rate)]
        gain = _SHARE * _SAFETY * _least(acceleration, slope)
        request.max_acceleration = [min(request.max_acceleration[0], gain)]
        self.duration = self._duration()

    def stop(self) -> None:
        """Brake from now on, on the line."""
        self._request.control_interface = ruckig.ControlInterface.Velocity

    def tick(self) -> tuple[Array, Array, Array]:
        """Return position (3,), rotation (3, 3) and velocity (6,) at the end of the coming tick."""
        self.is_done = self._law.update(self._request, self._answer) == ruckig.Result.Finished
        self._answer.pass_to_input(self._request)
        fraction, rate = self._answer.new_position[0], self._answer.new_velocity[0]
        line = self._line
        velocity = np.concatenate((line.shift, line.rotation @ line.turn)) * rate
        return line.position_at(fraction), line.rotation_at(fraction), velocity


def _least(most: Array, values: Array) -> float:
    """Return the factor by which `values`, shape (n, joints), first reach `most`, shape (joints,)."""
    return 1.0 / max(float((values / most).max()), 1e-9)
