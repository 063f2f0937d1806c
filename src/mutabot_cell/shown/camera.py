"""A camera in the cell. Imports a GL backend for its first picture; nothing else in this package does.

On a machine without a screen choose one before Python starts: `MUJOCO_GL=egl` (Debian: libegl1) or
`MUJOCO_GL=osmesa` (Debian: libosmesa6).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass

import mujoco
import numpy as np

from mutabot_cell.simulation import Simulation

Pixels = np.ndarray[tuple[int, ...], np.dtype[np.uint8]]
#: pixels along the edge of the shadow map of a quick picture: without a graphics card shadows cost the most
_QUICK_SHADOWS = 1024


@dataclass(frozen=True, slots=True)
class View:
    """Where a camera stands.

    Attributes:
        azimuth, elevation: degrees.
        distance: from the camera to `look_at`, m.
        look_at: world frame, m.
    """

    azimuth: float = 140.0
    elevation: float = -22.0
    distance: float = 2.6
    look_at: tuple[float, float, float] = (0.1, 0.1, 1.05)


class Camera:
    """Takes pictures of a cell as it is at the time; changes nothing in it.

    Args:
        height, width: pixels, at most 960 by 1280.
        is_quick: whether shadows and edges may be coarse, which takes a third of the time.
    """

    def __init__(
        self, simulation: Simulation, height: int, width: int, view: View, *, is_quick: bool = False
    ) -> None:
        self._simulation = simulation
        self._height, self._width = height, width
        self._is_quick = is_quick
        self._renderer: mujoco.Renderer | None = None
        self._camera = mujoco.MjvCamera()
        self._camera.azimuth, self._camera.elevation = view.azimuth, view.elevation
        self._camera.distance = view.distance
        self._camera.lookat[:] = view.look_at
        self._looks = mujoco.MjvOption()
        self._looks.sitegroup[:] = 0

    def picture(self) -> Pixels:
        """Red, green and blue of each pixel, shape (height, width, 3), in an array of its own."""
        if self._renderer is None:
            self._renderer = self._made()
        self._renderer.update_scene(self._simulation.data, self._camera, self._looks)
        return np.ascontiguousarray(self._renderer.render())

    def close(self) -> None:
        """Let go of what GL holds for it."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _made(self) -> mujoco.Renderer:
        model = self._simulation.model
        with _coarse(model) if self._is_quick else nullcontext():
            return mujoco.Renderer(model, self._height, self._width)


@contextmanager
def _coarse(model: mujoco.MjModel) -> Iterator[None]:
    """What is made here draws coarsely; the model is as it was afterwards."""
    quality = model.vis.quality
    before = quality.shadowsize, quality.offsamples
    quality.shadowsize, quality.offsamples = _QUICK_SHADOWS, 0
    try:
        yield
    finally:
        quality.shadowsize, quality.offsamples = before
