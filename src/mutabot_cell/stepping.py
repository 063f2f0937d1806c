"""The physics, stepped by control ticks, or taken from memory where the same ticks were stepped before.

What a tick leads to depends on the model, on the state of the physics and on the inputs of the servos, and on
nothing else.
"""

from __future__ import annotations

import ctypes
import hashlib
from contextlib import suppress

import mujoco
import numpy as np

from mutabot import shared_memory

from .fingerprint import Fingerprint
from .geometry import Array

MOVING = int(mujoco.mjtState.mjSTATE_FULLPHYSICS | mujoco.mjtState.mjSTATE_WARMSTART)
"""What of a state changes within a tick."""

_STATE = int(mujoco.mjtState.mjSTATE_INTEGRATION) & ~int(mujoco.mjtState.mjSTATE_CTRL)
_SLEEP = int(mujoco.mjtEnableBit.mjENBL_SLEEP)
_CALLBACKS = (
    mujoco.get_mjcb_passive, mujoco.get_mjcb_control, mujoco.get_mjcb_contactfilter, mujoco.get_mjcb_sensor,
    mujoco.get_mjcb_act_dyn, mujoco.get_mjcb_act_gain, mujoco.get_mjcb_act_bias,
)  # fmt: skip


class Stepping:
    """Steps one cell's physics; the processes of a campaign remember together.

    What is remembered of a tick is the state before its last step. That step is carried out anew, since
    contacts, forces and the like are no part of a state.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self._model, self._data, self._servos = model, data, data.ctrl
        # plugins and flexible bodies may have more to them than a state tells
        self._memory = None if model.nplugin or model.nflex else shared_memory.shared()
        self._key: bytes | None = None
        self._start: Array = np.zeros(mujoco.mj_stateSize(model, _STATE))
        self._before: Array = np.zeros(mujoco.mj_stateSize(model, MOVING))
        self._fingerprint = Fingerprint(model)

    def tick(self, inputs: Array) -> None:
        """Step one tick.

        Args:
            inputs: of all servos, shape (physics steps in a tick, servos).
        """
        before = self.recall(inputs)
        if before is not None:
            self.end(before, inputs)
            return
        start = self._data.time
        self.step(inputs, self._before)
        # where MuJoCo begins anew, more has changed than what is kept
        if self._data.time - start > (len(inputs) - 0.5) * self._model.opt.timestep:
            self.keep(self._before)

    def recall(self, inputs: Array) -> Array | None:
        """What was kept when the physics was as it is now and had these inputs; None if nothing was."""
        self._key = None
        if self._memory is None or not self._is_told_by_state():
            return None
        mujoco.mj_getState(self._model, self._data, self._start, _STATE)
        everything = b"".join((self._fingerprint.now(), self._start.tobytes(), inputs.tobytes()))
        self._key = hashlib.sha256(everything).digest()[: shared_memory.KEY]
        kept = self._memory.get(self._key)
        return None if kept is None else np.frombuffer(kept)

    def _is_told_by_state(self) -> bool:
        """Whether nothing else decides, such as which islands sleep, or what callbacks do."""
        sleeps = self._model.opt.enableflags & _SLEEP
        return not sleeps and all(callback() is None for callback in _CALLBACKS)

    def keep(self, values: Array) -> None:
        """Keep values that follow from all that was given when `recall` was last asked."""
        if self._memory is not None and self._key is not None:
            self._memory.put(self._key, values.tobytes())

    def step(self, inputs: Array, before: Array) -> None:
        """Step one tick anew; `before` becomes the state before its last step."""
        model, data, step, servos = self._model, self._data, mujoco.mj_step, self._servos
        for row in inputs[:-1]:
            servos[:] = row
            step(model, data)
        mujoco.mj_getState(model, data, before, MOVING)
        servos[:] = inputs[-1]
        step(model, data)

    def end(self, before: Array, inputs: Array) -> None:
        """Carry out the last step of a tick, from the state before it."""
        mujoco.mj_setState(self._model, self._data, before, MOVING)
        self._servos[:] = inputs[-1]
        mujoco.mj_step(self._model, self._data)


def _measure_no_time() -> None:
    """Keep MuJoCo from measuring how long each part of a step takes, which costs 5 % of it and nobody reads.

    Its bindings set the clock when they are imported, and cannot take it away again.
    """
    with suppress(OSError, ValueError):  # another build may keep it elsewhere, and only be slower
        library = ctypes.PyDLL(mujoco._functions.__file__)
        ctypes.c_void_p.in_dll(library, "mjcb_time").value = None


_measure_no_time()
