"""A camera in the cell. Only this module imports a GL backend, for its first picture.

On a machine without a screen choose one before Python starts: `MUJOCO_GL=egl` (Debian: libegl1) or
`MUJOCO_GL=osmesa` (Debian: libosmesa6).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from mutabot_cell.parts import Vector3
from mutabot_cell.simulation import Simulation

if TYPE_CHECKING:
    from .looks.visual import VisualModel

Pixels = np.ndarray[tuple[int, ...], np.dtype[np.uint8]]
#: pixels along the edge of the shadow map of a quick picture: without a graphics card shadows cost the most
_QUICK_SHADOWS = 1024


@dataclass(frozen=True, slots=True)
class View:
    """The viewpoint of a camera.

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
    """Takes pictures of a cell as it is now, without changing it.

    Args:
        height, width: pixels, at most 960 by 1280.
        is_quick: whether shadows and edges may be coarse and the floor dull: an eighth of the time.
    """

    def __init__(
        self, simulation: Simulation, height: int, width: int, view: View, *, is_quick: bool = False
    ) -> None:
        self._simulation = simulation
        self._height, self._width = height, width
        self._is_quick = is_quick
        self._visual: VisualModel | None = None
        self._renderer: mujoco.Renderer | None = None
        self._camera = mujoco.MjvCamera()
        self._camera.azimuth, self._camera.elevation = view.azimuth, view.elevation
        self._camera.distance = view.distance
        self._camera.lookat[:] = view.look_at

    def picture(self, traces: Sequence[Sequence[Vector3]] = ()) -> Pixels:
        """Return red, green and blue of each pixel, shape (height, width, 3), as a new array.

        Args:
            traces: lines to draw, each through points of the world frame, m.
        """
        # here, so that no process that takes no pictures loads it
        from .looks.trace import draw_trace  # noqa: PLC0415

        if self._visual is None or self._renderer is None:
            self._visual, self._renderer = self._made()
        self._visual.pose()
        self._renderer.update_scene(self._visual.data, self._camera, self._visual.options)
        for trace in traces:
            draw_trace(self._renderer.scene, trace)
        return np.ascontiguousarray(self._renderer.render())

    def close(self) -> None:
        """Release the camera's GL resources."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _made(self) -> tuple[VisualModel, mujoco.Renderer]:
        from .looks.visual import VisualModel  # noqa: PLC0415  # as above

        visual = VisualModel(self._simulation)
        if self._is_quick:
            quality = visual.model.vis.quality
            quality.shadowsize, quality.offsamples = _QUICK_SHADOWS, 0
        renderer = mujoco.Renderer(visual.model, self._height, self._width)
        if self._is_quick:
            renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = 0
        return visual, renderer


class TracingCamera(Camera):
    """A camera whose pictures show the path of each robot's tool since the picture before."""

    def __init__(
        self, simulation: Simulation, height: int, width: int, view: View, *, is_quick: bool = False
    ) -> None:
        super().__init__(simulation, height, width, view, is_quick=is_quick)
        self._paths: list[list[Vector3]] = [[] for _ in simulation.robots]

    def picture(self, traces: Sequence[Sequence[Vector3]] = ()) -> Pixels:
        """Return a picture with the tools' paths; see `Camera.picture`."""
        robots = self._simulation.robots.values()
        for path, robot in zip(self._paths, robots, strict=True):
            x, y, z = self._simulation.data.site_xpos[robot.site].tolist()
            path.append((x, y, z))
        return super().picture((*traces, *self._paths))
