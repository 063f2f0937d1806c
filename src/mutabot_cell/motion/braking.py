"""Brings a motion in progress to rest."""

from __future__ import annotations

import math

import numpy as np
import ruckig

from mutabot_cell.geometry import Array
from mutabot_cell.models.limits import JointLimits

from .online import JointSteps
from .trajectory import Motion, sampled, time_law

_SHORTEST = 0.05
"""Half of the time for braking on the path that is tried first, s."""
_LONGER = 1.25


def braked(motion: Motion, begun: int, step: float, limits: JointLimits) -> Motion:
    """Return the rest of a motion after `begun` of its steps, slowed down to rest on the same path.

    Time is stretched until it stands still, as fast as the joints' acceleration limits allow. A motion that
    would end sooner by itself stays as it is.

    Args:
        step: of the motion's samples, s.
        limits: of the joints.
    """
    joints, speeds = motion.joints[begun - 1 :], motion.speeds[begun - 1 :]
    half = round(_SHORTEST / step)
    while half < len(joints) - 1:
        whole = 2 * half * step
        passed = np.linspace(0.0, 1.0, 20 * half + 1)
        # the rate at which the motion goes on falls from 1 to 0 as 1 - 3 u² + 2 u³; this is its integral
        gone = whole * (passed - passed**3 + passed**4 / 2)
        u = np.interp(np.arange(half + 1) * step, gone, passed)
        u[-1] = 1.0
        rate = 1.0 - 3 * u**2 + 2 * u**3
        slowed = sampled(u * whole, joints[: half + 1], speeds[: half + 1] * rate[:, None], step)
        if _is_gentle(slowed, speeds[0], step, limits):
            return slowed
        half = math.ceil(half * _LONGER)
    return Motion(joints[1:], speeds[1:])


def _is_gentle(motion: Motion, before: Array, step: float, limits: JointLimits) -> bool:
    accelerations = np.diff(np.concatenate((before[None], motion.speeds)), axis=0) / step
    return bool((np.abs(accelerations) <= np.array(limits.acceleration)).all())


def braked_joints(state: JointSteps, step: float, limits: JointLimits) -> Motion:
    """Return the quickest motion to rest, each joint on its own, sampled every `step` s."""
    count = len(state.joints)
    request = ruckig.InputParameter(count)
    request.control_interface = ruckig.ControlInterface.Velocity
    request.current_position, request.current_velocity = state.joints.tolist(), state.speeds.tolist()
    request.current_acceleration = state.accelerations.tolist()
    request.max_acceleration, request.max_jerk = list(limits.acceleration), list(limits.jerk)
    trajectory = time_law(ruckig.Ruckig(count), request)
    samples = max(1, math.ceil(trajectory.duration / step))
    times = (min((index + 1) * step, trajectory.duration) for index in range(samples))
    states = np.array([trajectory.at_time(time)[:2] for time in times])
    return Motion(states[:, 0], states[:, 1])
