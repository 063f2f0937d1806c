"""One step of inverse kinematics: mink's quadratic programme, set up in place and solved by daqp."""

from __future__ import annotations

import daqp
import mink
import mujoco
import numpy as np

from mutabot_cell.geometry import Array

_LIMIT_GAIN = 0.95
"""Part of the way to a joint's limit that one step may go."""
_REGULARISATION = 1e-12
"""Added to the diagonal, as mink does."""
_UNBOUNDED = -1e30
"""What daqp takes for no lower bound."""


class JointStep:
    """The joint step that brings the tool nearest to its target; bit by bit the result of `mink.solve_ik`.

    mink checks, copies and stacks the matrices of any tasks and any solver anew at each call, which takes
    four times as long as to solve the programme. Here the tasks are known: the tool's pose and, with a cost
    of its own, a posture.

    Args:
        model: of an arm whose joints turn or slide.
        frame: the tool's pose.
        posture_cost: of all joints; 0 for no posture.
    """

    def __init__(self, model: mujoco.MjModel, frame: mink.FrameTask, posture_cost: float) -> None:
        count, rows = model.nv, 6 + (model.nv if posture_cost else 0)
        self._frame, self._cost = frame, posture_cost
        self._rates: Array = np.zeros((rows, count))
        self._rates[6:] = (posture_cost * np.eye(count))[: rows - 6]
        self._errors: Array = np.zeros(rows)
        limited = np.flatnonzero(model.jnt_limited)
        self._limited, self._limits = limited, model.jnt_range[limited]
        bounded = np.eye(count)[limited]
        self._bounds = np.vstack((bounded, -bounded))
        self._nothing: Array = np.zeros((0, count))

    def solve(self, configuration: mink.Configuration, near: Array, *, limited: bool) -> Array:
        """Return how far each joint should move, shape (joints,), rad.

        Args:
            near: the posture, shape (joints,), rad.
            limited: whether the joints must stay within their ranges.

        Raises:
            mink.NoSolutionFound: the solver gave up.
        """
        joints, (rates, errors, damping) = configuration.q, self._frame.compute_qp_residual(configuration)
        self._rates[:6], self._errors[:6] = rates, errors
        if self._cost:
            self._errors[6:] = self._cost * -(joints - near)
        hessian = self._rates.T @ self._rates
        hessian.flat[:: len(joints) + 1] += _REGULARISATION + damping
        bounds, upper = self._nothing, np.zeros(0)
        if limited:
            now = joints[self._limited]
            bounds = self._bounds
            upper = _LIMIT_GAIN * np.concatenate((self._limits[:, 1] - now, now - self._limits[:, 0]))
        lower, sense = np.full(len(upper), _UNBOUNDED), np.zeros(len(upper), dtype=np.int32)
        step, _, flag, _ = daqp.solve(hessian, -(self._errors @ self._rates), bounds, upper, lower, sense)
        if flag <= 0:
            raise mink.NoSolutionFound("daqp")
        result: Array = step
        return result
