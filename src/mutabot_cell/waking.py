"""Keeps parts on a moving belt awake if parts at rest may sleep."""

from __future__ import annotations

import mujoco
import numpy as np

from .geometry import Array
from .simulation import Simulation

_BESIDE, _ABOVE = 0.2, 1.0
"""How far beside a belt and above it parts are kept awake, m: what stands on others moves with them."""
_SLEEP = int(mujoco.mjtEnableBit.mjENBL_SLEEP)
_ALLOWED = int(mujoco.mjtSleepPolicy.mjSLEEP_AUTO_ALLOWED)
_NEVER = int(mujoco.mjtSleepPolicy.mjSLEEP_NEVER)
_WAKING = 1e-12
"""Speed that wakes a part, m/s."""


class PartsOnBelt:
    """Keeps what lies on a moving belt awake.

    MuJoCo lets parts at rest sleep until something touches them; that a surface begins to move is no touch.
    """

    def __init__(self, simulation: Simulation, geom: int) -> None:
        model = simulation.model
        self._simulation, self._geom = simulation, geom
        sleeps = (model.tree_sleep_policy == _ALLOWED) & bool(model.opt.enableflags & _SLEEP)
        self._trees = np.flatnonzero(sleeps)
        self._dofs = model.tree_dofadr[self._trees]
        self._bodies = model.tree_bodyadr[self._trees]
        self._kept = np.zeros(len(self._trees), dtype=bool)
        self._most: Array = model.geom_size[geom] + np.array((_BESIDE, _BESIDE, _ABOVE))

    def keep(self) -> None:
        """Wake what is on the belt, and let sleep what no longer is."""
        if not len(self._trees):
            return
        data = self._simulation.data
        away = data.xpos[self._bodies] - data.geom_xpos[self._geom]
        over = (np.abs(away @ data.geom_xmat[self._geom].reshape(3, 3)) < self._most).all(axis=1)
        for index in np.flatnonzero(over != self._kept):
            self._set(int(index), kept=bool(over[index]))

    def let_sleep(self) -> None:
        """Let parts on the belt sleep, since it has stopped."""
        for index in np.flatnonzero(self._kept):
            self._set(int(index), kept=False)

    def _set(self, index: int, *, kept: bool) -> None:
        self._kept[index] = kept
        self._simulation.model.tree_sleep_policy[self._trees[index]] = _NEVER if kept else _ALLOWED
        if kept:  # MuJoCo wakes what has a speed
            self._simulation.data.qvel[self._dofs[index]] += _WAKING
