"""Several control ticks stepped in a row by MuJoCo, with what the ticks looked like at their ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import mujoco
import numpy as np
from mujoco.rollout import Rollout

from .geometry import Array

LONGEST = 50
"""Control ticks in a stretch at most."""

_STATE = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)
_USER = int(mujoco.mjtState.mjSTATE_USER)
"""What a step takes from outside: inputs of the servos first, then forces and the like."""


class Stretch:
    """Memory of one stretch, used again for the next.

    Attributes:
        inputs: of all servos, shape (LONGEST, physics steps in a tick, servos).
        places, speeds, readings: `qpos`, `qvel`, `sensordata` at the end of each tick, shapes (LONGEST, n).
        states: all that moves, at each physics step, shape (LONGEST, values of all steps in a tick).
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, steps: int) -> None:
        self._model, self._data, self._steps = model, data, steps
        self._before = mujoco.MjData(model)
        self._rollout = Rollout(nthread=0).rollout
        self._user: Array = np.zeros(mujoco.mj_stateSize(model, _USER))
        given: Array = np.zeros((LONGEST, steps, len(self._user)))
        self._start: Array = np.zeros((1, mujoco.mj_stateSize(model, _STATE)))
        states: Array = np.zeros((LONGEST, steps, self._start.size))
        readings: Array = np.zeros((LONGEST, steps, model.nsensordata))
        self.inputs = given[:, :, : model.nu]
        self._rest = given[:, :, model.nu :]
        self.states = states.reshape(LONGEST, -1)
        self._times = states[:, -1, 0]
        self.places = states[:, -1, 1 : 1 + model.nq]
        self.speeds = states[:, -1, 1 + model.nq : 1 + model.nq + model.nv]
        self.readings = readings[:, -1]
        # of each tick: the state it starts from, and the arrays that the rollout reads and fills
        self._ticks = [
            (states[number - 1, -1:] if number else self._start, given[number, None], states[number, None],
             readings[number, None])
            for number in range(LONGEST)
        ]  # fmt: skip
        self._lists = [model], [data]
        self._warmstart = data.qacc_warmstart[None]

    def run(self, ticks: int, notes: Sequence[Callable[[int], None]]) -> bool:
        """Step so many ticks from the present state; each of `notes` is called after each tick.

        Returns:
            Whether all went well: a rollout gives up a tick in which MuJoCo warns.
        """
        model, data = self._model, self._data
        mujoco.mj_copyData(self._before, model, data)
        mujoco.mj_getState(model, data, self._start[0], _STATE)
        mujoco.mj_getState(model, data, self._user, _USER)
        self._rest[:ticks] = self._user[model.nu :]
        self._step(ticks, notes)
        step, wanted = model.opt.timestep, ticks * self._steps
        return bool(self._times[ticks - 1] - self._start[0, 0] > (wanted - 0.5) * step)

    def go_back(self, ticks: int) -> None:
        """Return to the state that the last run had after so many of its ticks."""
        mujoco.mj_copyData(self._data, self._model, self._before)
        self._step(ticks, ())

    def _step(self, ticks: int, notes: Sequence[Callable[[int], None]]) -> None:
        (models, datas), roll, warm, steps = self._lists, self._rollout, self._warmstart, self._steps
        for number in range(ticks):
            start, given, states, readings = self._ticks[number]
            roll(
                models,
                datas,
                start,
                given,
                control_spec=_USER,
                skip_checks=True,
                nstep=steps,
                initial_warmstart=warm,
                state=states,
                sensordata=readings,
            )
            for note in notes:
                note(number)
