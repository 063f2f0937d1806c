"""Steps several control ticks in a row, and keeps the state at each one's end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import mujoco
import numpy as np

from .geometry import Array
from .integrity import STRETCHES, are_original
from .stepping import MOVING, Stepping

LONGEST = 50
"""Control ticks in a stretch at most."""


StretchNote = Callable[["Stretch", int], None]
"""Called after a tick of a stretch, with its number."""


class Stretch:
    """The recorded states of a stretch; the memory is reused for the next.

    Attributes:
        inputs: of all servos, shape (LONGEST, physics steps in a tick, servos).
        places, speeds, readings: `qpos`, `qvel`, `sensordata` at the end of each tick, shapes (LONGEST, n).
        constraints, motors: `qfrc_constraint`, `qfrc_actuator` likewise.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, stepping: Stepping, steps: int) -> None:
        self._model, self._data, self._stepping = model, data, stepping
        self._steps = steps
        self._start = mujoco.MjData(model)
        self.inputs: Array = np.zeros((LONGEST, steps, model.nu))
        ends = (data.qpos, data.qvel, data.qfrc_constraint, data.qfrc_actuator, data.sensordata)
        first = mujoco.mj_stateSize(model, MOVING)
        borders = np.cumsum([first, *map(len, ends)]).tolist()
        self._ticks: Array = np.zeros((LONGEST, borders[-1]))
        self._before = self._ticks[:, :first]
        columns = [self._ticks[:, begin:end] for begin, end in pairwise(borders)]
        self._ends = list(zip(columns, ends, strict=True))
        self.places, self.speeds, self.constraints, self.motors, self.readings = columns
        self._reached = 0

    def run(self, ticks: int, notes: Sequence[StretchNote]) -> bool:
        """Step this many ticks from the present state; each of `notes` is called after each tick.

        Returns:
            Whether all went well: MuJoCo begins anew where its numbers are beyond hope.
        """
        data, inputs = self._data, self.inputs[:ticks]
        start = data.time
        mujoco.mj_copyData(self._start, self._model, data)
        known = self._stepping.recall(inputs) if are_original(STRETCHES, self) else None
        if known is not None:
            self._ticks[:ticks] = known.reshape(ticks, -1)
            self._reached = -1
        for number in range(ticks):
            if known is None:
                self._step(number)
            for note in notes:
                note(self, number)
        self.reach(ticks - 1)
        is_well = bool(data.time - start > (ticks - 0.5) * self._steps * self._model.opt.timestep)
        if is_well and known is None and are_original(STRETCHES, self):
            self._stepping.keep(self._ticks[:ticks])
        return is_well

    def reach(self, number: int) -> None:
        """While a stretch runs, restore the physics at the end of a recorded tick."""
        if number != self._reached:
            self._stepping.end(self._before[number], self.inputs[number])
            self._reached = number

    def go_back(self, ticks: int) -> None:
        """Return to the state that the last run had after this many ticks."""
        mujoco.mj_copyData(self._data, self._model, self._start)
        for number in range(ticks):
            self._step(number)

    def _step(self, number: int) -> None:
        self._stepping.step(self.inputs[number], self._before[number])
        for column, now in self._ends:
            column[number] = now
        self._reached = number
