"""A pytest plug-in that writes down a simulated cell after each control tick. It knows nothing of mutabot.

The environment variable ``WATCH`` names the file to write: a pickle of one dictionary per cell and test.
"""

from __future__ import annotations

import os
import pickle
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

#: what is written, a list of cells for each test
seen: dict[str, list[dict[str, Any]]] = {}
_running = [""]


class Watch:
    """Looks at one cell after each tick."""

    def __init__(self, simulation: Any, parts: list[Any]) -> None:
        self.simulation, self.model, self.data = simulation, simulation.model, simulation.data
        self.parts = {part.name: self.model.body(part.name).id for part in parts}
        self.sites = {f"{prefix}tool": robot.site for prefix, robot in simulation.robots.items()}
        self.names = [self._name(geom) for geom in range(self.model.ngeom)]
        self.limited = np.flatnonzero(self.model.jnt_limited)
        self.cell: dict[str, Any] = {
            "edges": {part.name: part.extent for part in parts},
            "robots": set(),
            "times": [],
            "poses": {name: [] for name in (*self.sites, *self.parts)},
            "touching": [],
            "values": {},
        }
        for prefix in simulation.robots:
            self.cell["robots"] |= {f"{prefix}arm", f"{prefix}gripper", f"{prefix}suction cup"}
        seen.setdefault(_running[0], []).append(self.cell)
        self.look()
        simulation.after_tick.append(self.look)

    def look(self) -> None:
        """Write down what is now."""
        cell, data = self.cell, self.data
        cell["times"].append(self.simulation.time)
        turn = np.zeros(4)
        for name, site in self.sites.items():
            mujoco.mju_mat2Quat(turn, data.site_xmat[site])
            cell["poses"][name].append((*data.site_xpos[site], *turn))
        for name, body in self.parts.items():
            cell["poses"][name].append((*data.xpos[body], *data.xquat[body]))
        pairs = {tuple(sorted((self.names[a], self.names[b]))) for a, b in data.contact.geom[: data.ncon]}
        cell["touching"].append(frozenset(pair for pair in pairs if pair[0] != pair[1]))
        for prefix, robot in self.simulation.robots.items():
            cell["values"].setdefault(f"{prefix}fingers closed", []).append(robot.closed_path())
            margins = []
            for name in robot.model.joints:
                joint = self.model.joint(prefix + name)
                if self.model.jnt_limited[joint.id]:
                    angle = data.qpos[self.model.jnt_qposadr[joint.id]]
                    low, high = self.model.jnt_range[joint.id]
                    margins.append(np.degrees(min(angle - low, high - angle)))
            margin = min(margins, default=float("nan"))
            cell["values"].setdefault(f"{prefix}joint limit margin", []).append(margin)

    def _name(self, geom: int) -> str:
        """The part, the robot's gripper or arm, or the name of what stands there."""
        body = int(self.model.geom_bodyid[geom])
        above = [body]
        while body:
            body = int(self.model.body_parentid[body])
            above.append(body)
        names = [self.model.body(parent).name for parent in above[:-1]]
        for prefix, robot in self.simulation.robots.items():
            tool = robot.model.tool
            if tool is not None and prefix + tool.body in names:
                is_cup = "Suction" in type(tool.effector).__name__
                return f"{prefix}{'suction cup' if is_cup else 'gripper'}"
            joints = [self.model.joint(prefix + joint) for joint in robot.model.joints]
            if self.model.body_rootid[above[0]] in {
                self.model.body_rootid[joint.bodyid[0]] for joint in joints
            }:
                return f"{prefix}arm"
        return str(names[-1] if names else self.model.geom(geom).name or "world")


def pytest_configure() -> None:
    """Watch every cell that is made."""
    from mutabot_cell.simulation import Simulation  # noqa: PLC0415  # the project's path is set by now

    made = Simulation.__init__

    def watched(self: Any, scene: Any, *args: Any, **named: Any) -> None:
        made(self, scene, *args, **named)
        Watch(self, list(scene.parts))

    Simulation.__init__ = watched  # type: ignore[method-assign]


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Any:
    """Which test runs."""
    _running[0] = item.nodeid
    return (yield)


def pytest_sessionfinish() -> None:
    """Write all down."""
    Path(os.environ["WATCH"]).write_bytes(pickle.dumps(seen))
