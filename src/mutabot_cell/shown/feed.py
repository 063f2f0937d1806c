"""The feed of a cell: tool, boxes, fingers, contacts, and what stands around."""

from __future__ import annotations

import math
from collections.abc import Callable

import mujoco
import numpy as np

from mutabot.evidence import Feed
from mutabot_cell.foresight import Glance
from mutabot_cell.robot import Robot
from mutabot_cell.scene import Scene
from mutabot_cell.simulation import TICK, Simulation
from mutabot_cell.stretch import LONGEST

from .camera import Camera, View
from .contacts import Contacts

#: of a film: from where robot, conveyor and table are seen, pixels, pictures per simulated second
_VIEW = View(azimuth=90.0, elevation=-33.0, distance=2.05, look_at=(0.0, 0.1, 0.96))
_HEIGHT, _WIDTH, _RATE = 450, 600, 12.5


def tell_of(simulation: Simulation, scene: Scene) -> Feed:
    """A feed of this cell; it tells something only while a test is recorded."""
    feed, data = Feed(lambda: simulation.time), simulation.data
    for prefix, robot in simulation.robots.items():
        feed.pose(f"{prefix}tool", _tool_pose(data, robot))
    for part in scene.parts:
        body = simulation.id_of("body", part.name)
        feed.pose(part.name, _pose(data, body), size=part.extent)
    for prefix, robot in simulation.robots.items():
        feed.value(f"{prefix}fingers closed", robot.closed_path, unit="m")
    feed.contacts(Contacts(simulation).read)
    for fixture in scene.fixtures:
        feed.block(fixture.name, fixture.centre, fixture.size, fixture.rgba)
    feed.camera(Camera(simulation, _HEIGHT, _WIDTH, _VIEW, is_quick=True).picture, rate=_RATE)
    simulation.after_tick.append(feed.tick)
    simulation.foresight.checks(feed.tick, Glance(lambda: _ticks_until(feed.due, simulation.time)))
    return feed


def _tool_pose(data: mujoco.MjData, robot: Robot) -> Callable[[], list[float]]:
    site, turned = robot.site, np.zeros(4)

    def tool() -> list[float]:
        mujoco.mju_mat2Quat(turned, data.site_xmat[site])
        return [*data.site_xpos[site].tolist(), *turned.tolist()]

    return tool


def _ticks_until(due: float, time: float) -> int:
    """Within how many ticks the feed must be called: rather one too few than too many."""
    return math.ceil(min(max((due - time) / TICK - 0.01, 1), LONGEST))


def _pose(data: mujoco.MjData, body: int) -> Callable[[], list[float]]:
    return lambda: [*data.xpos[body].tolist(), *data.xquat[body].tolist()]
