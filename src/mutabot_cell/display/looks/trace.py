"""Draws the path of a tool as a line into a scene."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import mujoco
import numpy as np

from mutabot_cell.parts import Vector3

_COLOUR = (0.96, 0.42, 0.10, 1.0)
_RADIUS = 0.0035
_SHORTEST = 0.004
"""A piece of the line that is shorter waits for more of it, m."""


def draw_trace(scene: mujoco.MjvScene, points: Sequence[Vector3], colour: Sequence[float] = _COLOUR) -> None:
    """Draw a line through points, world frame, m; only its end if the scene has too little room.

    Args:
        colour: red, green, blue and opacity from 0 to 1.
    """
    paint = np.array(colour, dtype=np.float32)
    kept = list(points[:1])
    for point in points[1:]:
        if np.linalg.norm(np.subtract(point, kept[-1])) >= _SHORTEST:
            kept.append(point)
    room = scene.maxgeom - scene.ngeom
    for start, end in list(pairwise(kept))[-room:] if room else ():
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(
            geom, mujoco.mjtGeom.mjGEOM_CAPSULE, np.zeros(3), np.zeros(3), np.eye(3).ravel(), paint
        )
        mujoco.mjv_connector(geom, mujoco.mjtGeom.mjGEOM_CAPSULE, _RADIUS, np.array(start), np.array(end))
        geom.emission = 0.35
        scene.ngeom += 1
