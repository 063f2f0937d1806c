"""Joint angles for a pose: damped least squares from where the joints are, nearest solution first."""

from __future__ import annotations

import math
from typing import Any

from .frames import Frame

_ROUNDS = 120
_NEAR = 2e-6
_DAMPING = 1e-4
_LONGEST = 0.3


def joint_target(
    kinematics: Any, model: Any, target: Frame, near: list[float], *, is_limited: bool = True
) -> list[float] | None:
    """Return joint angles, degrees, with the cell's tool point at ``target``; None if none are found.

    Args:
        kinematics: of the arm: ``tool(joints)`` and ``jacobian()``.
        model: of the robot: its home position and the ranges of its joints.
        target: robot base frame.
        near: joint angles, degrees: what is nearest to them is preferred.
        is_limited: whether the joints have to stay in their ranges.
    """
    import numpy as np  # noqa: PLC0415  # comes with the cell

    start = np.radians(np.array(near, dtype=float))
    home = np.array(model.home, dtype=float)
    limits = np.array(model.ranges).T if is_limited else (-np.inf, np.inf)
    wanted = _matrix(np, target)
    position = np.array(target.position)
    turn = _azimuth(np, kinematics, start, position)
    seeds = [start]
    for base in (start, home):
        for shift in (turn, -turn, 0.0):
            seed = base.copy()
            seed[0] = start[0] + shift
            seeds.append(seed)
    seeds.append(home)
    found: list[tuple[float, Any]] = []
    for seed in seeds:
        solution = _solve(np, kinematics, limits, position, wanted, seed)
        if solution is not None:
            solution = _wrapped(np, model, solution, start)
            distance = float(np.abs(solution - start).max())
            if distance < math.pi / 2:  # as near as another configuration cannot be
                return [float(angle) for angle in np.degrees(solution)]
            found.append((distance, solution))
    if not found:
        return None
    return [float(angle) for angle in np.degrees(min(found, key=lambda reached: reached[0])[1])]


def _solve(np: Any, kinematics: Any, limits: Any, position: Any, wanted: Any, seed: Any) -> Any:
    joints = seed.copy()
    for _ in range(_ROUNDS):
        at, rotation = kinematics.tool(joints)
        error = np.concatenate((position - at, _turn(np, wanted @ rotation.T)))
        if float(np.abs(error).max()) < _NEAR:
            return joints
        jacobian = kinematics.jacobian()
        size = min(1.0, float(np.linalg.norm(error)))
        damped = jacobian @ jacobian.T + _DAMPING * size * np.eye(6)
        step = jacobian.T @ np.linalg.solve(damped, error)
        longest = float(np.abs(step).max())
        if longest > _LONGEST:
            step *= _LONGEST / longest
        joints = np.clip(joints + step, *limits)
    return None


def _turn(np: Any, rotation: Any) -> Any:
    """Return the rotation vector, rad, of a rotation matrix."""
    axis = np.array(
        [rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]]
    )
    sine = 0.5 * float(np.linalg.norm(axis))
    cosine = 0.5 * (float(np.trace(rotation)) - 1.0)
    if sine < 1e-9:
        return axis * 0.5 if cosine > 0 else np.array([math.pi, 0.0, 0.0])
    return axis * (math.atan2(sine, cosine) / (2.0 * sine))


def _azimuth(np: Any, kinematics: Any, start: Any, position: Any) -> float:
    at, _ = kinematics.tool(start)
    there, here = math.atan2(position[1], position[0]), math.atan2(at[1], at[0])
    return (there - here + math.pi) % (2 * math.pi) - math.pi


def _wrapped(np: Any, model: Any, solution: Any, start: Any) -> Any:
    """Remove full turns where the joint's range lets them."""
    wrapped = solution.copy()
    for index, (low, high) in enumerate(model.ranges):
        turned = solution[index] + 2 * math.pi * round((start[index] - solution[index]) / (2 * math.pi))
        if low <= turned <= high:
            wrapped[index] = turned
    return wrapped


def _matrix(np: Any, frame: Frame) -> Any:
    return np.array([frame.turn(axis) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]).T
