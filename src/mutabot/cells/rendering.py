"""Pictures of the cell. Imports a GL backend when first used; nothing else in this package does.

On a machine without a screen choose one before Python starts: `MUJOCO_GL=egl` (Debian: libegl1) or
`MUJOCO_GL=osmesa` (Debian: libosmesa6).
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import mujoco
import numpy as np

from .cell import Cell

_LOOK_AT = (0.1, 0.1, 1.05)


def render(
    cell: Cell,
    path: str | Path,
    *,
    width: int = 800,
    height: int = 600,
    azimuth: float = 140.0,
    elevation: float = -22.0,
    distance: float = 2.6,
    look_at: tuple[float, float, float] = _LOOK_AT,
) -> Path:
    """Write a PNG picture of the cell as it is now, and return its path.

    Args:
        width, height: pixels, at most 1280 by 960.
        azimuth, elevation: of the camera, degrees.
        distance: from the camera to `look_at`, m.
        look_at: world frame, m.
    """
    camera = mujoco.MjvCamera()
    camera.azimuth, camera.elevation, camera.distance = azimuth, elevation, distance
    camera.lookat[:] = look_at
    looks = mujoco.MjvOption()
    looks.sitegroup[:] = 0
    simulation = cell.simulation
    with mujoco.Renderer(simulation.model, height, width) as renderer:
        renderer.update_scene(simulation.data, camera, looks)
        pixels = renderer.render()
    path = Path(path)
    path.write_bytes(_png(np.ascontiguousarray(pixels)))
    return path


def _png(pixels: np.ndarray[tuple[int, ...], np.dtype[np.uint8]]) -> bytes:
    """PNG file of RGB pixels, shape (height, width, 3)."""
    height, width = pixels.shape[:2]

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    # each row is stored as its difference to the row above ("up" filter): much smaller files
    rows = pixels.reshape(height, -1)
    above = np.vstack((np.zeros_like(rows[:1]), rows[:-1]))
    filtered = np.hstack((np.full((height, 1), 2, np.uint8), rows - above))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    data = zlib.compress(filtered.tobytes(), 9)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")
