"""A stereo camera that measures depth. It casts rays, so it needs no screen.

Its errors are those of stereo: both imagers must see a point, and the depth follows from a disparity in
pixels that is matched with some error and reported in steps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np

from mutabot_cell.models.noise import SeededNoise

from .geometry import Array, rotation_from_euler
from .light_barrier import SOLID
from .scene import DepthCamera
from .simulation import Simulation

STEPS, MOST_DISPARITY = 32, 126.0
"""Steps of the disparity per pixel, and the largest one that is searched for, pixels: the D400's."""
FARTHEST = 3.0
"""End of the range of the D415, m."""
FLATTEST = 80.0
"""A surface that is seen flatter than at this angle from its normal is not matched, degrees (our choice)."""
SECONDS = 0.05
"""From one picture to its use, s: a frame and a half of 30 a second (our choice)."""

_SAME = 0.001
"""The right imager sees a point if nothing lies before it by more than this, m."""


@dataclass(frozen=True, slots=True)
class DepthPicture:
    """What a depth camera has measured.

    Attributes:
        depth: along the camera's axis, shape (rows, columns), m; NaN where nothing was measured.
        points: the same in the world frame, shape (rows, columns, 3), m.
        time: when it was taken, simulated time, s.
    """

    depth: Array
    points: Array
    time: float


class StereoCamera:
    """A depth camera of the cell."""

    def __init__(self, simulation: Simulation, camera: DepthCamera, noise: SeededNoise) -> None:
        self._simulation, self._camera, self._noise = simulation, camera, noise
        self._left: Array = np.array(camera.position)
        self._axes = rotation_from_euler(*camera.angles)
        self._right: Array = self._left + camera.baseline * self._axes[:, 0]
        rays = _rays(camera)
        self._shape = rays.shape[:2]
        self._rays: Array = (rays @ self._axes.T).reshape(-1, 3)

    def picture(self) -> DepthPicture:
        """Take a picture of what there is now; return it after 50 ms, which pass."""
        depth = self._measured()
        time = self._simulation.time
        points = self._left + depth[:, None] * self._rays
        self._simulation.advance(SECONDS)
        return DepthPicture(depth.reshape(self._shape), points.reshape(*self._shape, 3), time)

    def _measured(self) -> Array:
        """Return the depth for each ray, shape (rays,), m; NaN where there is none."""
        lengths = np.linalg.norm(self._rays, axis=1)
        depth, normals = self._cast(self._left, self._rays)
        flatness = np.abs((normals * self._rays).sum(axis=1)) / lengths
        is_seen = (depth > 0.0) & (depth < FARTHEST) & (flatness > math.cos(math.radians(FLATTEST)))
        found = np.flatnonzero(is_seen)
        is_seen[found] = self._right_sees(self._left + depth[found, None] * self._rays[found])
        with np.errstate(divide="ignore"):
            disparity = self._camera.focal_length * self._camera.baseline / depth
        disparity += self._noise.field(f"disparity of {self._camera.name}", self._camera.subpixel, len(depth))
        if self._noise.is_enabled:
            disparity = np.round(disparity * STEPS) / STEPS
        is_seen &= (disparity > 0.0) & (disparity <= MOST_DISPARITY)
        measured: Array = np.full(len(depth), np.nan)
        measured[is_seen] = self._camera.focal_length * self._camera.baseline / disparity[is_seen]
        return measured

    def _right_sees(self, points: Array) -> Array:
        """Return which points, shape (points, 3), the right imager sees, shape (points,)."""
        rays = points - self._right
        share, _ = self._cast(self._right, rays)
        seen: Array = (1.0 - share) * np.linalg.norm(rays, axis=1) < _SAME
        return seen

    def _cast(self, start: Array, rays: Array) -> tuple[Array, Array]:
        """Return after how many times its length each ray hits something, -1 for nothing, and the normals."""
        count = len(rays)
        lengths: Array = np.linalg.norm(rays, axis=1)
        hits, normals = np.zeros(count, dtype=np.int32), np.zeros(3 * count)
        found: Array = np.zeros(count)
        mujoco.mj_multiRay(
            self._simulation.model,
            self._simulation.data,
            start,
            (rays / lengths[:, None]).ravel(),
            SOLID,
            1,
            -1,
            hits,
            found,
            normals,
            count,
            2.0 * FARTHEST,
        )
        return np.where(found < 0.0, -1.0, found / lengths), normals.reshape(-1, 3)


def _rays(camera: DepthCamera) -> Array:
    """Return a ray for each pixel in the camera's frame with a depth of 1, shape (rows, columns, 3)."""
    columns, rows = (
        (np.arange(count // camera.decimation) + 0.5) * camera.decimation - count / 2
        for count in (camera.columns, camera.rows)
    )
    across, down = np.meshgrid(columns / camera.focal_length, rows / camera.focal_length)
    return np.stack([across, down, np.ones_like(across)], axis=-1)
