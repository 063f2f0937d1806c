"""The lines that represent a robot: from its base through its joints, and its fingers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import mujoco
import numpy as np

from mutabot_cell.models.effectors import Fingers
from mutabot_cell.robot import Robot
from mutabot_cell.simulation import Simulation

#: m: between these is how thick a link is drawn, and so thick is one without a shape
_THINNEST, _THICKEST, _USUAL = 0.012, 0.09, 0.03
#: m: bodies nearer to each other are at one place
_SAME = 1e-3
#: of a finger, m; where knuckles are between the flange and the tool point
_FINGER, _KNUCKLES = 0.009, 0.5


class SkeletonLine(NamedTuple):
    """A line of a skeleton.

    Attributes:
        name: of what.
        read: gives x, y, z of one point after the other, m, world frame.
        radii: how thick it is at each of them, m.
    """

    name: str
    read: Callable[[], list[float]]
    radii: tuple[float, ...]


def skeleton_of(simulation: Simulation, robot: Robot) -> Iterator[SkeletonLine]:
    """Yield the lines of a robot: its arm, and its fingers if it has any."""
    model, data = simulation.model, simulation.data
    chain = _chain(simulation, robot)
    radii = _radii(model, chain)
    places, site = data.xpos, data.site_xpos[robot.site]
    fingers = None if robot.model.tool is None else robot.model.tool.effector
    if not isinstance(fingers, Fingers):
        yield SkeletonLine(
            f"{robot.prefix}arm",
            lambda: [*places[chain].ravel().tolist(), *site.tolist()],
            (*radii, radii[-1]),
        )
        return
    flange = places[chain[-1]]
    pads = [model.geom(robot.prefix + name).id for name in fingers.pads]
    first, second = data.geom_xpos[pads[0]], data.geom_xpos[_farthest(data, pads)]

    def arm() -> list[float]:
        palm = flange + _KNUCKLES * (site - flange)
        return [*places[chain].ravel().tolist(), *palm.tolist()]

    def jaws() -> list[float]:
        back = _KNUCKLES * (flange - site)
        return [*first.tolist(), *(first + back).tolist(), *(second + back).tolist(), *second.tolist()]

    yield SkeletonLine(f"{robot.prefix}arm", arm, (*radii, radii[-1]))
    yield SkeletonLine(f"{robot.prefix}fingers", jaws, (_FINGER,) * 4)


def _chain(simulation: Simulation, robot: Robot) -> list[int]:
    """Return the bodies from the base to the tool point; of two at one place the latter."""
    parents, places = simulation.model.body_parentid, simulation.data.xpos
    found = [int(simulation.model.site_bodyid[robot.site])]
    while found[-1] not in (robot.body, 0):
        found.append(int(parents[found[-1]]))
    chain = found[::-1]
    apart = [float(np.linalg.norm(places[body] - places[after])) for body, after in pairwise(chain)]
    return [body for body, far in zip(chain, [*apart, 1.0], strict=True) if far > _SAME]


def _radii(model: mujoco.MjModel, chain: Sequence[int]) -> tuple[float, ...]:
    """Return the radii of a chain's links; the base, which has none, gets that of the first link."""
    found = [_radius(model, body) for body in chain]
    return (found[min(1, len(found) - 1)], *found[1:])


def _radius(model: mujoco.MjModel, body: int) -> float:
    """Return the radius of the largest shape of a body."""
    first, count = int(model.body_geomadr[body]), int(model.body_geomnum[body])
    sizes = [sorted(model.geom_aabb[geom, 3:].tolist())[1] for geom in range(first, first + count)]
    return min(_THICKEST, max(_THINNEST, *sizes)) if sizes else _USUAL


def _farthest(data: mujoco.MjData, pads: list[int]) -> int:
    """Return the pad that is farthest from the first: on the other side."""
    apart = np.linalg.norm(data.geom_xpos[pads] - data.geom_xpos[pads[0]], axis=1)
    return pads[int(apart.argmax())]
