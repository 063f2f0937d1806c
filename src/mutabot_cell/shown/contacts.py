"""What touches what in the cell, by names that a person would use."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco

from mutabot_cell.models.model import ROBOT_BODY
from mutabot_cell.simulation import Simulation


class Contacts:
    """The contacts of a simulation."""

    def __init__(self, simulation: Simulation) -> None:
        self._data = simulation.data
        model = simulation.model
        #: what bodies are parts of, by the first body up the tree that says so
        self._parts = {prefix + ROBOT_BODY: f"{prefix}arm" for prefix in simulation.robots}
        for prefix, robot in simulation.robots.items():
            if robot.model.tool is not None:
                self._parts[prefix + robot.model.tool.body] = f"{prefix}gripper"
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
            if name in self._parts:
                return self._parts[name]
            if int(model.body_parentid[body]) == 0:
                return str(name)
            body = int(model.body_parentid[body])
        return str(model.geom(geom).name) or "world"
