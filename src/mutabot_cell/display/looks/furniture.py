"""Draws tables, stands, pedestals and light barriers."""

from __future__ import annotations

import math

import mujoco
import numpy as np

from mutabot_cell.models.model import is_on_pedestal
from mutabot_cell.models.robot import RobotModel
from mutabot_cell.scene import Fixture, LightBarrier

from .style import BOX, CAPSULE, CYLINDER, hide, show

_LEG, _FOOT = 0.025, 0.02
"""Half width of a leg's profile and height of its foot, m."""
_SMALLEST_TABLE = 0.3
"""What is narrower is a block and stays one, m."""


def dress_table(spec: mujoco.MjSpec, fixture: Fixture) -> None:
    """Draw a fixture that is wide enough, and off the floor, as a table with a board on a frame."""
    width, depth, height = fixture.size
    body, geom = spec.body(fixture.name), spec.geom(fixture.name)
    if not has_legs(fixture) or min(width, depth) < _SMALLEST_TABLE or height > 0.2:
        return
    hide(geom)
    board = min(height / 2, 0.014)
    top = height / 2 - board
    red, green, blue, alpha = fixture.rgba
    show(body, BOX, (width / 2, depth / 2, board - 0.001), (0, 0, top + 0.001), rgba=fixture.rgba)
    edge = (0.72 * red, 0.72 * green, 0.72 * blue, alpha)
    show(body, BOX, (width / 2 + 0.002, depth / 2 + 0.002, board - 0.002), (0, 0, top - 0.001), rgba=edge)
    under = height / 2 - board
    if under > 0.004:
        inside = (width / 2 - 0.03, depth / 2 - 0.03, under)
        show(body, BOX, inside, (0, 0, -board), material="aluminium")
    add_stand(body, fixture, inset=0.06)


def has_legs(fixture: Fixture) -> bool:
    """Return whether a fixture is upright, and above the floor."""
    return fixture.centre[2] - fixture.size[2] / 2 > 0.1 and not any(fixture.angles[:2])


def add_stand(body: mujoco.MjsBody, fixture: Fixture, inset: float) -> None:
    """Draw four legs with feet, and rails between them; `inset` from the ends, m."""
    if not has_legs(fixture):
        return
    width, depth, height = fixture.size
    below = fixture.centre[2] - height / 2
    ends = (width / 2 - 0.06, depth / 2 - 0.06)
    ends = (ends[0], depth / 2 - inset) if depth > width else (width / 2 - inset, ends[1])
    middle = -(height + below) / 2
    for x in (-ends[0], ends[0]):
        for y in (-ends[1], ends[1]):
            show(body, BOX, (_LEG, _LEG, below / 2 - _FOOT), (x, y, middle + _FOOT), material="aluminium")
            foot = -height / 2 - below
            show(body, CYLINDER, (0.008, _FOOT, 0), (x, y, foot + _FOOT), material="steel")
            show(body, CYLINDER, (0.035, 0.008, 0), (x, y, foot + 0.008), material="black")
    rail = -height / 2 - 0.72 * below
    for side in (-1, 1):
        show(body, BOX, (0.018, ends[1], 0.018), (side * ends[0], 0, rail), material="aluminium")
        show(body, BOX, (ends[0], 0.018, 0.018), (0, side * ends[1], rail), material="aluminium")


def dress_pedestal(spec: mujoco.MjSpec, prefix: str, robot: RobotModel) -> None:
    """Draw the cylinder below a robot as a column between two flanges."""
    if not is_on_pedestal(robot):
        return
    geom, world, base = spec.geom(f"{prefix}pedestal"), spec.worldbody, robot.base
    hide(geom)
    x, y, height = base.x, base.y, base.z
    show(world, CYLINDER, (0.072, height / 2, 0), (x, y, height / 2), material="anthracite")
    for middle, radius, half in ((0.011, 0.17, 0.011), (height - 0.011, 0.10, 0.011)):
        show(world, CYLINDER, (radius, half, 0), (x, y, middle), material="steel")
        for number in range(8):
            angle = math.pi * (number + 0.5) / 4
            bolt = (x + 0.86 * radius * math.cos(angle), y + 0.86 * radius * math.sin(angle))
            show(world, CYLINDER, (0.008, 0.005, 0), (*bolt, middle + half), material="black")
    for number in range(4):
        angle = math.pi * number / 2
        turned = (math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2))
        rib = (x + 0.105 * math.cos(angle), y + 0.105 * math.sin(angle), 0.06)
        show(world, BOX, (0.04, 0.005, 0.045), rib, material="anthracite", quat=turned)


def dress_barrier(spec: mujoco.MjSpec, barrier: LightBarrier) -> None:
    """Draw a housing at each end of the beam, and the beam."""
    start, end = np.array(barrier.start), np.array(barrier.end)
    along = (end - start) / np.linalg.norm(end - start)
    quat = np.zeros(4)
    mujoco.mju_quatZ2Vec(quat, along)
    turned = tuple(quat.tolist())
    for place, way in ((start, -1), (end, 1)):
        x, y, z = (place + way * 0.022 * along).tolist()
        show(spec.worldbody, BOX, (0.012, 0.016, 0.02), (x, y, z), material="yellow", quat=turned)
    length = float(np.linalg.norm(end - start)) / 2
    x, y, z = ((start + end) / 2).tolist()
    beam = (0.95, 0.15, 0.10, 0.35)
    show(spec.worldbody, CAPSULE, (0.0012, length, 0), (x, y, z), rgba=beam, quat=turned)
