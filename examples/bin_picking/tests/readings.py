"""What tests read of the simulation: where parts are, what touches what, and where faces really are."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from station import BIN, BIN_SIZE, CUBE, NUT, PLATE, TABLE_TOP, TRAY_SIZE, TRAYS, Station

from mutabot_cell.geometry import Array

SUNK = 0.02
"""Parts that are lower than this below the table's top have fallen off it, m."""


def middles(station: Station) -> Array:
    """The middle of each part, shape (parts, 3), world frame, m."""
    data = station.cell.simulation.data
    return np.array([data.body(name).xpos for name in station.names]).reshape(-1, 3)


def in_bin(station: Station) -> list[str]:
    """The parts whose middle is in the bin."""
    off = np.abs(middles(station)[:, :2] - BIN)
    inside = (off < np.array(BIN_SIZE) / 2).all(axis=1)
    return [name for name, is_inside in zip(station.names, inside, strict=True) if is_inside]


def in_trays(station: Station) -> dict[str, int]:
    """How many parts of each shape lie in the tray of that shape."""
    found = dict.fromkeys(TRAYS, 0)
    for name, (x, y, z) in zip(station.names, middles(station).tolist(), strict=True):
        off = np.abs(np.array((x, y)) - TRAYS[station.shape(name)])
        found[station.shape(name)] += bool((off < np.array(TRAY_SIZE) / 2).all() and z > TABLE_TOP - SUNK)
    return found


def nearest(station: Station) -> float:
    """The smallest distance between the middles of two parts, m."""
    places = middles(station)
    return min(math.dist(place, other) for at, place in enumerate(places) for other in places[:at])


def touch_of_bin(station: Station) -> Callable[[], float]:
    """Gives how deep the robot presses into the bin, m; 0 if it does not touch it."""
    model, data = station.cell.simulation.model, station.cell.simulation.data
    roots = model.body_rootid[model.geom_bodyid]
    is_robot = roots == model.body_rootid[model.body("cup").id]
    is_bin = np.array([model.geom(geom).name.startswith("bin ") for geom in range(model.ngeom)])

    def depth() -> float:
        one, other = data.contact.geom.T
        both = (is_robot[one] & is_bin[other]) | (is_bin[one] & is_robot[other])
        return float(max(0.0, -data.contact.dist[both].min(initial=0.0)))

    return depth


def fall_outside(station: Station) -> Callable[[], float]:
    """Gives how fast a part falls that is not above the bin, m/s."""
    simulation = station.cell.simulation
    model, data = simulation.model, simulation.data
    bodies = [simulation.id_of("body", name) for name in station.names]
    dofs = model.body_dofadr[bodies] + 2
    half = np.array(BIN_SIZE) / 2

    def speed() -> float:
        outside = (np.abs(data.xpos[bodies, :2] - BIN) > half).any(axis=1)
        return float(max(0.0, -data.qvel[dofs][outside].min(initial=0.0)))

    return speed


def true_face(station: Station, place: Array, normal: Array) -> tuple[str, float, float]:
    """The part next to a place on a face with a normal, both of shape (3,), world frame.

    Returns:
        Its name, how far the place is off the part's own face, m, and the angle between both, degrees.
    """
    data = station.cell.simulation.data
    name = min(station.names, key=lambda value: math.dist(data.body(value).xpos, place))
    body, best = data.body(name), (math.inf, math.inf)
    for axis, distance in drawn_faces(station.shape(name)):
        outward = body.xmat.reshape(3, 3) @ axis
        angle = math.degrees(math.acos(min(1.0, float(outward @ normal))))
        best = min(best, (angle, abs(float((place - body.xpos) @ outward) - distance)))
    return name, best[1], best[0]


def drawn_faces(shape: str) -> list[tuple[Array, float]]:
    """The normal of each face of a shape, shape (3,), part's frame, and its distance from the middle, m."""
    if shape == "nut":
        edge, thickness = NUT
        turns = [math.radians(30 + 60 * side) for side in range(6)]
        sides = [(np.array([math.cos(turn), math.sin(turn), 0.0]), edge * 3**0.5 / 2) for turn in turns]
        return [*sides, *((np.array([0.0, 0.0, way]), thickness / 2) for way in (1.0, -1.0))]
    size = PLATE if shape == "plate" else (CUBE,) * 3
    return [(way * np.eye(3)[axis], size[axis] / 2) for axis in range(3) for way in (1.0, -1.0)]
