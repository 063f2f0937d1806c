"""What the cell tells mutabot of itself while a test is recorded: tool, boxes, fingers, contacts."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import mujoco
import numpy as np

from mutabot.evidence import Feed

from .scene import Scene
from .simulation import Simulation

#: what bodies without a name of their own are parts of, by the first body in the tree that says so
_PARTS = {"gripper": "gripper", "robot": "arm"}


def tell_of(simulation: Simulation, scene: Scene) -> Feed:
    """A feed of this cell; it tells something only while a test is recorded."""
    feed, data = Feed(lambda: simulation.time), simulation.data
    site = simulation.id_of("site", "tool")
    turned = np.zeros(4)

    def tool() -> list[float]:
        mujoco.mju_mat2Quat(turned, data.site_xmat[site])
        return [*data.site_xpos[site].tolist(), *turned.tolist()]

    feed.pose("tool", tool)
    for box in scene.boxes:
        body = simulation.id_of("body", box.name)
        feed.pose(box.name, _pose(data, body), size=(box.edge, box.edge, box.edge))
    closed = data.ten_length
    feed.value("fingers closed", lambda: closed[0], unit="m")
    feed.contacts(_Contacts(simulation).read)
    for fixture in scene.fixtures:
        feed.block(fixture.name, fixture.centre, fixture.size, fixture.rgba)
    simulation.after_tick.append(feed.tick)
    return feed


def _pose(data: mujoco.MjData, body: int) -> Callable[[], list[float]]:
    return lambda: [*data.xpos[body].tolist(), *data.xquat[body].tolist()]


class _Contacts:
    """Which parts touch which, by names that a person would use."""

    def __init__(self, simulation: Simulation) -> None:
        self._data = simulation.data
        model = simulation.model
        self._names = [self._name(model, geom) for geom in range(model.ngeom)]

    def read(self) -> Iterator[tuple[str, str]]:
        """The pairs that touch now; parts of the arm among themselves do not count."""
        count = self._data.ncon
        if not count:
            return
        for one, other in set(map(tuple, self._data.contact.geom[:count].tolist())):
            pair = self._names[one], self._names[other]
            if pair[0] != pair[1]:
                yield pair

    def _name(self, model: mujoco.MjModel, geom: int) -> str:
        body = int(model.geom_bodyid[geom])
        while body:
            name = model.body(body).name
            if name in _PARTS:
                return _PARTS[name]
            if int(model.body_parentid[body]) == 0:
                return str(name)
            body = int(model.body_parentid[body])
        return str(model.geom(geom).name) or "world"
