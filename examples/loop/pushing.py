"""A table on which a finger pushes a puck to a mark: simulated, and driven step by step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

PERIOD = 0.04
"""Of one step, s."""
REACH = 0.004
"""How far the finger's target moves in one step at most, along each axis, m: 0.1 m/s."""
PUCK, FINGER = 0.03, 0.015
"""Radii, m."""
NOISE = 0.0005
"""Of the camera that sees the puck, standard deviation along each axis, m."""
GOAL = (0.22, 0.06)
"""Where the puck is to go (x, y), m."""

_MODEL = f"""
<mujoco>
  <option timestep="0.002" integrator="implicitfast"/>
  <worldbody>
    <geom type="plane" size="1 1 0.1" friction="0.4"/>
    <body name="puck" pos="0 0 0.011">
      <freejoint/>
      <geom type="cylinder" size="{PUCK} 0.01" mass="0.1" friction="0.4" condim="4"/>
    </body>
    <body name="finger" pos="0 0 0.016">
      <joint name="x" type="slide" axis="1 0 0" damping="20"/>
      <joint name="y" type="slide" axis="0 1 0" damping="20"/>
      <geom type="sphere" size="{FINGER}" mass="0.3" friction="0.3"/>
    </body>
  </worldbody>
  <actuator>
    <position joint="x" kp="400" forcerange="-12 12"/>
    <position joint="y" kp="400" forcerange="-12 12"/>
  </actuator>
</mujoco>
"""


@dataclass(frozen=True)
class Seen:
    """What sensors tell after a step.

    Attributes:
        finger: where the finger is (x, y), m.
        puck: where the camera sees the puck (x, y), m.
    """

    finger: tuple[float, float]
    puck: tuple[float, float]


class Pushing:
    """The table.

    Args:
        seed: of the camera's noise, and of where the puck lies: within 1 cm of the origin.
        finger: where the finger begins (x, y), m.
    """

    def __init__(self, seed: int = 0, finger: tuple[float, float] = (-0.12, -0.05)) -> None:
        self._random = np.random.default_rng(seed)
        model: Any = mujoco.MjModel.from_xml_string(_MODEL)
        self._model, self._data = model, mujoco.MjData(model)
        self._data.qpos[:2] = self._random.uniform(-0.01, 0.01, 2)
        self._data.joint("x").qpos[0], self._data.joint("y").qpos[0] = finger
        self._data.ctrl[:] = finger
        mujoco.mj_forward(self._model, self._data)

    def step(self, action: Sequence[float]) -> Seen:
        """Move the finger's target by ``action`` (x, y), m, limited to REACH, and let one period pass."""
        self._data.ctrl[:] += np.clip(action, -REACH, REACH)
        self.advance()
        return self.look()

    def advance(self) -> float:
        """Let one period pass; returns the time, s."""
        for _ in range(round(PERIOD / self._model.opt.timestep)):
            mujoco.mj_step(self._model, self._data)
        return float(self._data.time)

    def look(self) -> Seen:
        """What sensors tell now."""
        x, y = (float(self._data.joint(name).qpos[0]) for name in "xy")
        seen = self._data.qpos[:2] + self._random.normal(0.0, NOISE, 2)
        return Seen((x, y), (float(seen[0]), float(seen[1])))

    @property
    def time(self) -> float:
        """Since the beginning, s."""
        return float(self._data.time)

    @property
    def puck(self) -> tuple[float, float]:
        """Where the puck is (x, y), m: what the camera is compared with."""
        return float(self._data.qpos[0]), float(self._data.qpos[1])

    @property
    def height(self) -> float:
        """How high the puck's middle is above the table, m."""
        return float(self._data.qpos[2])
