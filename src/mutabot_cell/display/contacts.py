"""The contacts in the cell, by names that a person would use."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco

from mutabot_cell.models.effectors import SuctionCup
from mutabot_cell.models.model import ROBOT_BODY
from mutabot_cell.models.sleeping import awake
from mutabot_cell.simulation import Simulation


class Contacts:
    """The contacts of a simulation."""

    def __init__(self, simulation: Simulation) -> None:
        self._data, self._model = simulation.data, simulation.model
        #: what bodies are parts of, by the first body up the tree that says so
        self._parts = {prefix + ROBOT_BODY: f"{prefix}arm" for prefix in simulation.robots}
        for prefix, robot in simulation.robots.items():
            if robot.model.tool is not None:
                has_cup = isinstance(robot.model.tool.effector, SuctionCup)
                name = "suction cup" if has_cup else "gripper"
                self._parts[prefix + robot.model.tool.body] = prefix + name
        self._names = [self._name(self._model, geom) for geom in range(self._model.ngeom)]
        self._sleepers = b""
        self._sleeping: set[tuple[int, int]] = set()

    @property
    def robots(self) -> tuple[str, ...]:
        """The names of the parts of robots."""
        return tuple(self._parts.values())

    def read(self) -> Iterator[tuple[str, str]]:
        """Yield the pairs that touch now, without those within an arm."""
        for first, second in _touching(self._data) | self._asleep():
            pair = self._names[first], self._names[second]
            if pair[0] != pair[1]:
                yield pair

    def _asleep(self) -> set[tuple[int, int]]:
        """Return contacts of sleeping bodies, which MuJoCo does not list and which do not change."""
        states = self._data.body_awake
        if self._data.nbody_awake == states.size:
            return set()
        if states.tobytes() != self._sleepers:
            self._sleepers = states.tobytes()
            whole = mujoco.MjData(self._model)
            whole.qpos[:] = self._data.qpos
            with awake(self._model):
                mujoco.mj_kinematics(self._model, whole)
                mujoco.mj_collision(self._model, whole)
            self._sleeping = {pair for pair in _touching(whole) if self._is_asleep(pair)}
        return self._sleeping

    def _is_asleep(self, pair: tuple[int, int]) -> bool:
        states = [self._data.body_awake[self._model.geom_bodyid[geom]] for geom in pair]
        return mujoco.mjtSleepState.mjS_ASLEEP in states and mujoco.mjtSleepState.mjS_AWAKE not in states

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


def _touching(data: mujoco.MjData) -> set[tuple[int, int]]:
    return set(map(tuple, data.contact.geom[: data.ncon].tolist()))
