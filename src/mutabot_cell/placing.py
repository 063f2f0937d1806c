"""Moves fixtures without rebuilding the cell, to misplace them."""

from __future__ import annotations

from collections.abc import Iterable

import mujoco
import numpy as np

from mutabot_cell.models.sleeping import awake
from mutabot_cell.parts import Vector3

from .errors import BadArgument
from .geometry import Array, quaternion_from_euler
from .simulation import Simulation

Placement = tuple[Array, Array]
"""A position, shape (3,), m, and a unit quaternion, shape (4,)."""


def move_fixture(
    simulation: Simulation,
    name: str,
    centre: Vector3,
    angles: Vector3 = (0.0, 0.0, 0.0),
    *,
    carried: Iterable[str] = (),
) -> None:
    """Move a fixture at once. Parts on it stay in place, unless they are named.

    Args:
        name: of the fixture.
        centre: of the fixture, world frame, m.
        angles: Euler angles x, y, z, degrees.
        carried: names of parts that keep their place on it.

    Raises:
        BadArgument: there is no such fixture or part.
    """
    place_fixture(simulation, name, (np.array(centre), quaternion_from_euler(*angles)), carried)


def fixture_placement(simulation: Simulation, name: str) -> Placement:
    """Return where a fixture stands, world frame. Raises BadArgument if there is no such fixture."""
    model, body = simulation.model, _body(simulation, name, is_free=False)
    return model.body_pos[body].copy(), model.body_quat[body].copy()


def place_fixture(simulation: Simulation, name: str, after: Placement, carried: Iterable[str]) -> None:
    """Move a fixture, and the parts that keep their place on it, at once; world frame.

    Raises:
        BadArgument: there is no such fixture or part.
    """
    model, data = simulation.model, simulation.data
    body, before = _body(simulation, name, is_free=False), fixture_placement(simulation, name)
    parts = [_body(simulation, part, is_free=True) for part in carried]
    model.body_pos[body], model.body_quat[body] = after
    for part in parts:
        place = data.qpos[model.jnt_qposadr[model.body_jntadr[part]] :][:7]
        place[:3], place[3:] = _carried(before, after, (place[:3].copy(), place[3:].copy()))
    with awake(model):
        mujoco.mj_forward(model, data)


def _carried(before: Placement, after: Placement, pose: Placement) -> Placement:
    """Return the pose that relates to `after` as `pose` did to `before`."""
    back, place, turned = (np.zeros(3), np.zeros(4)), np.zeros(3), np.zeros(4)
    mujoco.mju_negPose(*back, *before)
    mujoco.mju_mulPose(place, turned, *back, *pose)
    moved = np.zeros(3), np.zeros(4)
    mujoco.mju_mulPose(*moved, *after, place, turned)
    return moved


def _body(simulation: Simulation, name: str, *, is_free: bool) -> int:
    model = simulation.model
    found = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    if found < 1 or (model.body_jntnum[found] > 0) != is_free or model.body_parentid[found] != 0:
        what = "part" if is_free else "fixture"
        raise BadArgument(f"Expected the name of a {what} of the cell but got {name!r}")
    return int(found)
