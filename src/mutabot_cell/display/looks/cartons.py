"""Draws parts as cartons: boxes with bevelled edges, a printed label on top and a mark on the sides."""

from __future__ import annotations

import math
from itertools import product

import mujoco
import numpy as np

from mutabot_cell.parts import Box, Part, Vector3

from .style import BOX, LOOKS, hide, named, show

_SKIN = 0.00015
"""How far print stands off the surface, m."""
#: bars of a label from left to right: place and half width, as shares of the label's width
_BARS = ((-0.40, 0.020), (-0.33, 0.012), (-0.26, 0.028), (-0.18, 0.012), (-0.11, 0.020), (-0.02, 0.028))
#: strokes of the mark: place along and up, half length, angle in degrees; shares of the box's edge
_STROKES = ((-0.165, 0.0, 0.15, 70.0), (-0.055, 0.0, 0.13, -65.0), (0.055, 0.0, 0.13, 65.0),
            (0.165, 0.0, 0.15, -70.0))  # fmt: skip


def dress_part(spec: mujoco.MjSpec, part: Part) -> None:
    """Draw a box as a carton; other parts keep their shape."""
    if not isinstance(part, Box):
        return
    body, geom = spec.body(part.name), spec.geom(part.name)
    hide(geom)
    smallest = min(part.size)
    spec.add_mesh(
        name=named(part.name), uservert=_broken(part.size, 0.045 * smallest).ravel(), smoothnormal=False
    )
    shape = show(body, mujoco.mjtGeom.mjGEOM_MESH, (0, 0, 0), rgba=part.looks)
    shape.meshname, shape.group = named(part.name), LOOKS
    _print_label(body, part.size)
    _print_mark(body, part.size)


def _broken(size: Vector3, cut: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return the corners of a box whose edges are bevelled at 45 degrees, shape (24, 3), m."""
    halves = np.array(size) / 2
    corners = []
    for signs in product((-1, 1), repeat=3):
        for axis in range(3):
            inside = np.full(3, cut)
            inside[axis] = 0.0
            corners.append(np.array(signs) * (halves - inside))
    return np.array(corners)


def _print_label(body: mujoco.MjsBody, size: Vector3) -> None:
    width, depth, top = 0.62 * size[0], 0.40 * size[1], size[2] / 2
    middle = -0.16 * size[1]
    show(body, BOX, (width / 2, depth / 2, _SKIN), (0, middle, top), material="paper")
    for place, half in _BARS:
        bar = (half * width, 0.34 * depth, 2 * _SKIN)
        show(body, BOX, bar, (place * width, middle, top), material="ink")
    for line, half in ((0.22, 0.20), (0.02, 0.20), (-0.20, 0.12)):
        text = (half * width, 0.05 * depth, 2 * _SKIN)
        show(body, BOX, text, ((0.05 + half) * width, middle + line * depth, top), material="ink")


def _print_mark(body: mujoco.MjsBody, size: Vector3) -> None:
    """Draw a zigzag line on the two sides that face along y."""
    edge = min(size[0], size[2])
    for side in (-1, 1):
        for along, up, half, degrees in _STROKES:
            angle = math.radians(degrees) / 2
            show(
                body,
                BOX,
                (half * edge, _SKIN, 0.03 * edge),
                (along * edge, side * size[1] / 2, up * edge),
                material="paper",
                quat=(math.cos(angle), 0.0, -math.sin(angle), 0.0),
            )
