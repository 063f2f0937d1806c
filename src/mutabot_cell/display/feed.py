"""Feeds the recording of a test: tool, boxes, fingers, contacts, and surroundings."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np

from mutabot.api.processes import Feed
from mutabot_cell.lookahead import QuickCheck
from mutabot_cell.robot import Robot
from mutabot_cell.scene import Scene
from mutabot_cell.simulation import TICK, Simulation
from mutabot_cell.stretch import LONGEST, Stretch

from .camera import TracingCamera, View
from .contacts import Contacts
from .skeleton import skeleton_of

#: of a film: from where robot, conveyor and table are seen, pixels, pictures per simulated second
_VIEW = View(azimuth=90.0, elevation=-33.0, distance=2.05, look_at=(0.0, 0.1, 0.96))
_HEIGHT, _WIDTH, _RATE = 450, 600, 12.5
#: s: the feed is called rather too early, when nothing is new, than too late
_EARLY = 1e-5


def make_feed(simulation: Simulation, scene: Scene) -> Feed:
    """Return a feed of this cell, which is active only while a test is recorded."""
    feed, data = Feed(lambda: simulation.time), simulation.data
    for prefix, robot in simulation.robots.items():
        feed.pose(f"{prefix}tool", _tool_pose(data, robot))
    for part in scene.parts:
        body = simulation.id_of("body", part.name)
        feed.pose(part.name, _pose(data, body), size=part.extent)
    for prefix, robot in simulation.robots.items():
        feed.value(f"{prefix}fingers closed", robot.closed_path, unit="m")
        margin = _limit_margin(simulation, robot)
        if margin is not None:
            feed.value(f"{prefix}joint limit margin", margin, unit="deg")
        for line in skeleton_of(simulation, robot):
            feed.line(line.name, line.read, radii=line.radii)
    contacts = Contacts(simulation)
    feed.contacts(contacts.read, robots=contacts.robots)
    for fixture in scene.fixtures:
        feed.block(fixture.name, fixture.centre, fixture.size, fixture.rgba)
    feed.camera(TracingCamera(simulation, _HEIGHT, _WIDTH, _VIEW, is_quick=True).picture, rate=_RATE)
    _FeedCaller(simulation, feed)
    return feed


def _tool_pose(data: mujoco.MjData, robot: Robot) -> Callable[[], list[float]]:
    site, turned = robot.site, np.zeros(4)

    def tool() -> list[float]:
        mujoco.mju_mat2Quat(turned, data.site_xmat[site])
        return [*data.site_xpos[site].tolist(), *turned.tolist()]

    return tool


def _limit_margin(simulation: Simulation, robot: Robot) -> Callable[[], float] | None:
    """Return a function for the smallest distance of a joint from its limit, deg; None without limits."""
    model, places = simulation.model, simulation.data.qpos
    joints = [model.joint(robot.prefix + name).id for name in robot.model.joints]
    limited = [joint for joint in joints if model.jnt_limited[joint]]
    if not limited:
        return None
    where, (lower, upper) = model.jnt_qposadr[limited], model.jnt_range[limited].T
    return lambda: float(np.degrees(np.minimum(places[where] - lower, upper - places[where]).min()))


class _FeedCaller:
    """Calls a feed whenever it is due, also in the middle of a stretch."""

    def __init__(self, simulation: Simulation, feed: Feed) -> None:
        self._simulation, self._feed = simulation, feed
        self._due = 0.0
        simulation.after_tick.append(feed.tick)
        simulation.lookahead.add_check(feed.tick, QuickCheck(self._until, self._note))

    def _until(self) -> int:
        self._due = self._feed.due - _EARLY
        return 1 if self._due < self._simulation.time else LONGEST

    def _note(self, _: Stretch, number: int) -> None:
        if (self._simulation.ticks + number + 1) * TICK < self._due:
            return
        self._simulation.call_within_stretch(self._feed.tick, number)
        self._due = self._feed.due - _EARLY


def _pose(data: mujoco.MjData, body: int) -> Callable[[], list[float]]:
    return lambda: [*data.xpos[body].tolist(), *data.xquat[body].tolist()]
