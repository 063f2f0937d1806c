"""Forward and inverse kinematics of the arm: joint paths that keep the tool on a straight line.

Forward kinematics comes from MuJoCo, inverse kinematics from mink and daqp.
"""

from __future__ import annotations

import math
from copy import copy

import mink
import mujoco
import numpy as np

from mutabot_cell.errors import MotionRefused
from mutabot_cell.fingerprint import Fingerprint
from mutabot_cell.geometry import Array
from mutabot_cell.models.assembly import TOOL_SITE, build_arm
from mutabot_cell.models.robot import RobotModel

from .joint_step import JointStep
from .line import Line
from .reach import WristReach
from .rounded_path import RoundedPath
from .trajectory import Spline

LIMIT_MARGIN = 0.005
"""How far the planner stays away from each joint limit, rad."""
POSITION_TOLERANCE = 5e-5
ROTATION_TOLERANCE = 2e-4
STRAIGHTNESS = 4e-4
"""Largest allowed distance of the tool from its line, m; knots are added until it holds."""
TURN_STRAIGHTNESS = 2e-3
"""Largest allowed deviation of the tool's orientation from the interpolated one, rad."""

_KNOT_DISTANCE = 0.03
_KNOT_ANGLE = math.radians(5.0)
_KNOTS_OF_A_BEND = 4
_MOST_KNOTS = 512
_RETRIED_KNOTS = 64
_LARGEST_KNOT_STEP = 0.5
_ITERATIONS = 40
_POSTURE_COST = 1e-3
_DAMPING = 1e-3
"""Of the solver for arms without redundancy, which have nothing to choose: it vanishes with the error."""
_ORIENTATION_COST = 0.3


class Kinematics:
    """The kinematics of the arm without the cell around it. The base frame is the world frame here.

    Attributes:
        count: of the arm's joints.
    """

    def __init__(self, robot: RobotModel) -> None:
        self._model = build_arm(robot)
        self._data = mujoco.MjData(self._model)
        self.count: int = self._model.nv
        self._site = self._model.site(TOOL_SITE).id
        self._reach = WristReach(robot)
        self._solver: _Solver | None = None
        self._turns = np.zeros((6, self._model.nv))  # the tool's speed by joint speeds

    def fingerprint(self) -> bytes:
        """Return a value that differs between arms, bit by bit."""
        return Fingerprint(self._model).now()

    def tool(self, joints: Array) -> tuple[Array, Array]:
        """Return the tool's position (shape (3,), m) and rotation (shape (3, 3)) in the base frame.

        Args:
            joints: shape (joints,), rad.
        """
        self._data.qpos[:] = joints
        mujoco.mj_kinematics(self._model, self._data)
        return self._data.site_xpos[self._site].copy(), self._data.site_xmat[self._site].reshape(3, 3).copy()

    def jacobian(self) -> Array:
        """Return the Jacobian, shape (6, 7), for the last `tool` call: base frame, m and rad per rad."""
        mujoco.mj_comPos(self._model, self._data)
        jacobian = np.zeros((6, self._model.nv))
        mujoco.mj_jacSite(self._model, self._data, jacobian[:3], jacobian[3:], self._site)
        return jacobian

    def follow(self, joints: Array, line: Line | RoundedPath) -> Array:
        """Return joint angles at evenly spaced points of `line` from `joints` on: shape (knots, joints), rad.

        Between the knots a cubic spline (`trajectory.Spline`) keeps the tool on the line, within
        `STRAIGHTNESS`.

        Raises:
            MotionRefused: some point of the line cannot be reached within the joint limits.
        """
        self._reach.check(line)
        count = max(4, math.ceil(line.length / _KNOT_DISTANCE), math.ceil(line.angle / _KNOT_ANGLE))
        count = max(count, min(_MOST_KNOTS, math.ceil(_KNOTS_OF_A_BEND * line.length / line.finest)))
        while True:
            try:
                knots = self._knots(joints, line, count)
            except MotionRefused:
                # coarse knots can lose a path that exists where the joints turn fast
                if count > _RETRIED_KNOTS:
                    raise
                count *= 4
                continue
            largest_step = float(np.abs(np.diff(knots, axis=0)).max())
            if largest_step <= _LARGEST_KNOT_STEP and self._is_straight(Spline(knots), line, count):
                self.check_configuration(knots)
                return knots
            if count >= _MOST_KNOTS:
                raise MotionRefused(
                    "the line passes a singularity, where joints would have to jump by "
                    f"{math.degrees(largest_step):.0f} deg",
                    limit="singularity",
                    excess=math.degrees(largest_step),
                    unit="deg",
                )
            count *= 2

    def check_configuration(self, knots: Array) -> None:
        """Refuse a line on which a six-joint arm would change its configuration (elbow, wrist)."""
        if self._model.nv != 6:
            return
        side = 0.0
        for index, joints in enumerate(knots):
            now = self._side(joints)
            if now * side < 0:
                fraction = (index - 1) / (len(knots) - 1)
                raise MotionRefused(
                    f"at {fraction:.0%} of the line the arm would go through a singularity "
                    "into another configuration of elbow or wrist; move the joints there first",
                    limit="singularity",
                    fraction=fraction,
                )
            side = now

    def _side(self, joints: Array) -> float:
        """Return a number whose sign differs between configurations and which is 0 at their singularity."""
        self._data.qpos[:] = joints
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_jacSite(self._model, self._data, self._turns[:3], self._turns[3:], self._site)
        return float(np.linalg.det(self._turns))

    def _is_straight(self, spline: Spline, line: Line | RoundedPath, count: int) -> bool:
        fractions = (np.arange(count) + 0.5) / count
        for fraction, joints in zip(fractions.tolist(), spline.value(fractions), strict=True):
            position, rotation = self.tool(joints)
            if float(np.abs(position - line.position_at(fraction)).max()) > STRAIGHTNESS / 2:
                return False
            # |R - R'| (Frobenius) is sqrt(2) times the angle between them, for small angles
            if float(np.linalg.norm(rotation - line.rotation_at(fraction))) > 1.4 * TURN_STRAIGHTNESS:
                return False
        return True

    def _knots(self, joints: Array, line: Line | RoundedPath, count: int) -> Array:
        if self._solver is None:
            self._solver = _Solver(self._model)
        knots = np.empty((count + 1, len(joints)))
        knots[0] = joints
        for index in range(1, count + 1):
            guess = knots[index - 1] if index == 1 else 2 * knots[index - 1] - knots[index - 2]
            position, rotation = line.position_at(index / count), line.rotation_at(index / count)
            solution = self._solver.solve(position, rotation, guess, near=knots[index - 1])
            if solution is None:
                raise self._solver.refusal(position, rotation, knots[index - 1], fraction=(index - 1) / count)
            knots[index] = solution
        return knots


class _Solver:
    """mink set up for this arm: first the tool's pose, then a posture, within the joint limits."""

    def __init__(self, model: mujoco.MjModel) -> None:
        arm = copy(model)
        arm.jnt_range[:, 0] += LIMIT_MARGIN
        arm.jnt_range[:, 1] -= LIMIT_MARGIN
        limited = arm.jnt_limited.astype(bool)
        self._lower = np.where(limited, arm.jnt_range[:, 0], -np.inf)
        self._upper = np.where(limited, arm.jnt_range[:, 1], np.inf)
        self._configuration = mink.Configuration(arm)
        is_redundant = arm.nv > 6
        self._frame = mink.FrameTask(
            TOOL_SITE,
            "site",
            position_cost=1.0,
            orientation_cost=_ORIENTATION_COST,
            lm_damping=0.0 if is_redundant else _DAMPING,
        )
        self._step = JointStep(arm, self._frame, _POSTURE_COST if is_redundant else 0.0)

    def solve(
        self, position: Array, rotation: Array, guess: Array, *, near: Array, limited: bool = True
    ) -> Array | None:
        """Return joint angles, shape (joints,), rad, for a tool pose; None if there are none nearby."""
        transform = np.eye(4)
        transform[:3, :3] = rotation
        transform[:3, 3] = position
        self._frame.set_target(mink.SE3.from_matrix(transform))
        configuration = self._configuration
        configuration.update(np.clip(guess, self._lower, self._upper) if limited else guess)
        for _ in range(_ITERATIONS):
            step = self._step.solve(configuration, near, limited=limited)
            configuration.integrate_inplace(step, 1.0)
            error = self._frame.compute_error(configuration)
            if (
                math.dist(error[:3], (0, 0, 0)) < POSITION_TOLERANCE
                and math.dist(error[3:], (0, 0, 0)) < ROTATION_TOLERANCE
                and float(np.abs(step).max()) < 0.02
            ):
                return configuration.q.copy()
        return None

    def refusal(self, position: Array, rotation: Array, joints: Array, *, fraction: float) -> MotionRefused:
        """Return the refusal that says why the tool cannot move from `joints` to there."""
        at = f"at {fraction:.0%} of the line"
        free = self.solve(position, rotation, joints, near=joints, limited=False)
        if free is not None:
            over = np.maximum(free - self._upper, self._lower - free)
            worst = int(np.argmax(over))
            if over[worst] > 0:
                allowed = self._upper[worst] if free[worst] > self._upper[worst] else self._lower[worst]
                return MotionRefused(
                    f"joint {worst + 1} would need {math.degrees(free[worst]):.1f} deg {at}, "
                    f"{math.degrees(over[worst]):.1f} deg beyond its limit of "
                    f"{math.degrees(allowed):.1f} deg",
                    limit=f"joint {worst + 1}",
                    value=math.degrees(free[worst]),
                    allowed=math.degrees(allowed),
                    excess=math.degrees(over[worst]),
                    unit="deg",
                    fraction=fraction,
                )
        self.solve(position, rotation, joints, near=joints)
        error = self._frame.compute_error(self._configuration)
        gap = float(np.linalg.norm(error[:3]))
        turn = math.degrees(float(np.linalg.norm(error[3:])))
        return MotionRefused(
            f"no joint angles within the limits reach the line {at}; the tool would stay "
            f"{gap * 1000:.0f} mm and {turn:.1f} deg away from it",
            limit="reach",
            excess=gap,
            unit="m",
            fraction=fraction,
        )
