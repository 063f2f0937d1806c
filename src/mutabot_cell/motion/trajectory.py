"""Time laws of motions along a path, within limits of speed, acceleration and jerk.

ruckig gives the time-optimal law of a joint motion, and of the travelled fraction of a straight line.
Where a line asks a joint to be faster than it may be, time is stretched there, smoothly: the path stays the
same.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import ruckig

from mutabot_cell.geometry import Array
from mutabot_cell.models.limits import JointLimits, ToolLimits

_GRID = 0.01
"""Spacing of the grid on which time laws are computed, s."""
_SMOOTHING = 0.15
"""Half width of the window over which slowing down is spread, s."""

_SHORTEST_BRAKING = 0.05
"""Half of the time for braking on the path that is tried first, s."""
_SAFETY = 0.98
_LESS_JERK = (1.0, 0.999, 0.99)


@dataclass(frozen=True, slots=True)
class Motion:
    """The setpoints of a motion at every physics step.

    Attributes:
        joints: shape (steps, joints), rad.
        speeds: shape (steps, joints), rad/s.
    """

    joints: Array
    speeds: Array


class Spline:
    """A cubic spline through evenly spaced knots (not-a-knot ends), over a fraction of 0..1.

    Args:
        knots: shape (at least 4, joints), rad.
    """

    def __init__(self, knots: Array) -> None:
        intervals = len(knots) - 1
        step = 1.0 / intervals
        matrix = np.zeros((intervals + 1, intervals + 1))
        inner = np.arange(1, intervals)
        matrix[inner, inner - 1] = 1.0
        matrix[inner, inner] = 4.0
        matrix[inner, inner + 1] = 1.0
        matrix[0, :3] = matrix[-1, -3:] = (1.0, -2.0, 1.0)
        right = np.zeros_like(knots)
        right[1:-1] = 6.0 / step**2 * (knots[2:] - 2 * knots[1:-1] + knots[:-2])
        self._knots = knots
        self._bends = np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
        self._step = step
        self._intervals = intervals

    def _locate(self, fractions: Array) -> tuple[NDIndex, Array, Array]:
        index = np.clip((fractions * self._intervals).astype(np.intp), 0, self._intervals - 1)
        right = (fractions * self._intervals - index)[:, None]
        return index, 1.0 - right, right

    def value(self, fractions: Array) -> Array:
        """Return the values, shape (n, joints), at `fractions` of shape (n,)."""
        index, left, right = self._locate(fractions)
        bend = self._step**2 / 6.0
        result: Array = (
            left * self._knots[index]
            + right * self._knots[index + 1]
            + bend * ((left**3 - left) * self._bends[index] + (right**3 - right) * self._bends[index + 1])
        )
        return result

    def slope(self, fractions: Array) -> Array:
        """Return the first derivative by the fraction, shape (n, joints)."""
        index, left, right = self._locate(fractions)
        result: Array = (self._knots[index + 1] - self._knots[index]) / self._step + self._step / 6.0 * (
            (3 * right**2 - 1) * self._bends[index + 1] - (3 * left**2 - 1) * self._bends[index]
        )
        return result

    def bend(self, fractions: Array) -> Array:
        """Return the second derivative by the fraction, shape (n, joints)."""
        index, left, right = self._locate(fractions)
        result: Array = left * self._bends[index] + right * self._bends[index + 1]
        return result


NDIndex = np.ndarray[tuple[int, ...], np.dtype[np.intp]]


def joint_motion(start: Array, end: Array, step: float, limits: JointLimits, speed: float = 1.0) -> Motion:
    """Return the fastest synchronous motion between joint positions (joints,), rad, sampled every `step` s.

    `speed` scales the joints' speed limits, 0..1.
    """
    speeds, accelerations, jerks = _arrays(limits)
    times, values, rates, _ = _ruckig(start, end, speeds * speed, accelerations, jerks)
    return sampled(times, values, rates, step)


def line_motion(
    knots: Array,
    length: float,
    angle: float,
    step: float,
    limits: JointLimits,
    tool: ToolLimits,
    speed: float = 1.0,
) -> Motion:
    """Return the motion on a line whose evenly spaced joint angles are `knots`, shape (n, joints), rad.

    Args:
        length: of the line, m.
        angle: turned on it, rad.
        step: sampling, s.
        limits, tool: of joints and tool.
        speed: scales the tool's speed limits, 0..1.
    """
    spline = Spline(knots)

    def slowest(shift_limit: float, turn_limit: float) -> Array:
        shift = shift_limit / length if length > 1e-9 else math.inf
        turn = turn_limit / angle if angle > 1e-9 else math.inf
        return np.array([min(shift, turn, 1e6)])

    times, fraction, rate, second = _ruckig(
        np.zeros(1),
        np.ones(1),
        slowest(tool.speed * speed, tool.turn_speed * speed),
        slowest(tool.acceleration, tool.turn_acceleration),
        slowest(tool.jerk, tool.turn_jerk),
    )
    highest = _arrays(limits)
    places = np.clip(fraction[:, 0], 0.0, 1.0)
    slope = spline.slope(places)
    speeds = slope * rate
    accelerations = spline.bend(places) * rate**2 + slope * second
    factor = np.maximum(
        (np.abs(speeds) / (highest[0] * _SAFETY)).max(axis=1),
        np.sqrt((np.abs(accelerations) / (highest[1] * _SAFETY)).max(axis=1)),
    )
    stretch = _smooth(np.maximum(factor, 1.0), times[1] - times[0])
    stretched = np.concatenate(([0.0], np.cumsum(0.5 * (stretch[1:] + stretch[:-1]) * np.diff(times))))
    values, rates = spline.value(places), speeds / stretch[:, None]
    scale = _needed_slowdown(sampled(stretched, values, rates, _GRID), _GRID, highest)
    return sampled(stretched * scale, values, rates / scale, step)


def _arrays(limits: JointLimits) -> tuple[Array, Array, Array]:
    """Return the limits of speed, acceleration and jerk, shape (joints,) each."""
    return np.array(limits.speed), np.array(limits.acceleration), np.array(limits.jerk)


def _ruckig(
    start: Array, end: Array, speed: Array, acceleration: Array, jerk: Array
) -> tuple[Array, Array, Array, Array]:
    """Return times (n,), positions, speeds, accelerations (n, dof) of the fastest motion between rests."""
    count = len(start)
    request = ruckig.InputParameter(count)
    request.current_position, request.target_position = start.tolist(), end.tolist()
    request.max_velocity, request.max_acceleration = speed.tolist(), acceleration.tolist()
    request.max_jerk = jerk.tolist()
    trajectory = time_law(ruckig.Ruckig(count), request)
    times = np.linspace(0.0, trajectory.duration, max(2, math.ceil(trajectory.duration / _GRID) + 1))
    rows = [trajectory.at_time(time)[:3] for time in times.tolist()]
    states = np.array(rows).reshape(len(rows), 3, count)
    return times, states[:, 0], states[:, 1], states[:, 2]


def time_law(law: ruckig.Ruckig, request: ruckig.InputParameter) -> ruckig.Trajectory:
    """Compute the requested time law.

    Where two kinds of laws meet (a length of exactly 2 a³/j², say) ruckig finds neither in a few cases of a
    hundred, for the rounding of its inputs. A little less jerk, which the request then has, leads away.
    """
    trajectory = ruckig.Trajectory(request.degrees_of_freedom)
    jerks = list(request.max_jerk)
    for part in _LESS_JERK:
        request.max_jerk = [part * jerk for jerk in jerks]
        try:
            law.calculate(request, trajectory)
        except ruckig.RuckigError:
            if part == _LESS_JERK[-1]:
                raise
            continue
        break
    return trajectory


def _smooth(factor: Array, grid: float) -> Array:
    """Return a smooth curve that is nowhere below `factor`, shape (n,)."""
    half = max(1, round(_SMOOTHING / grid))
    if factor.max() <= 1.0 or len(factor) < 3:
        return factor
    padded = np.pad(factor, 2 * half, mode="edge")
    highest = np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1).max(axis=1)
    window = np.hanning(2 * half + 3)[1:-1]
    return np.convolve(highest, window / window.sum(), mode="valid")


def _needed_slowdown(motion: Motion, step: float, highest: tuple[Array, Array, Array]) -> float:
    """Return the factor (>= 1) by which the whole motion must be slower to keep all limits."""
    speeds = np.diff(motion.joints, axis=0) / step
    accelerations = np.diff(speeds, axis=0) / step
    jerks = np.diff(accelerations, axis=0) / step
    over = 1.0
    for order, (values, limits) in enumerate(zip((speeds, accelerations, jerks), highest, strict=True), 1):
        if len(values):
            over = max(over, float((np.abs(values) / limits).max()) ** (1 / order))
    return over


def sampled(times: Array, values: Array, rates: Array, step: float) -> Motion:
    """Interpolate by cubic Hermite splines every `step` s, with the last sample at or just after the end."""
    count = math.ceil(times[-1] / step - 1e-9)
    wanted = np.minimum(np.arange(1, count + 1) * step, times[-1])
    index = np.clip(np.searchsorted(times, wanted, side="right") - 1, 0, len(times) - 2)
    width = (times[index + 1] - times[index])[:, None]
    u = (wanted - times[index])[:, None] / width
    start, end = values[index], values[index + 1]
    start_rate, end_rate = rates[index] * width, rates[index + 1] * width
    joints = (
        (2 * u**3 - 3 * u**2 + 1) * start
        + (u**3 - 2 * u**2 + u) * start_rate
        + (3 * u**2 - 2 * u**3) * end
        + (u**3 - u**2) * end_rate
    )
    speeds = (
        6 * (u**2 - u) * (start - end) + (3 * u**2 - 4 * u + 1) * start_rate + (3 * u**2 - 2 * u) * end_rate
    ) / width
    return Motion(joints, speeds)
