"""Steps the physics by control ticks, or reuses earlier results of the same ticks.

What a tick leads to depends on the model, on the state of the physics and on the inputs of the servos, and on
nothing else.
"""

from __future__ import annotations

import ctypes
import hashlib
from contextlib import suppress
from typing import Any

import mujoco
import numpy as np

from mutabot.api.processes import SharedMemory

from .fingerprint import Fingerprint
from .geometry import Array
from .integrity import CodeRecord

MOVING = int(mujoco.mjtState.mjSTATE_FULLPHYSICS | mujoco.mjtState.mjSTATE_WARMSTART)
"""What of a state changes within a tick."""

_STATE = int(mujoco.mjtState.mjSTATE_INTEGRATION) & ~int(mujoco.mjtState.mjSTATE_CTRL)
_SLEEP = int(mujoco.mjtEnableBit.mjENBL_SLEEP)
_CALLBACKS = ("passive", "control", "contactfilter", "sensor", "act_dyn", "act_gain", "act_bias")


class Stepping:
    """Steps one cell's physics; the processes of a campaign share the results.

    What is remembered of a tick is the state before its last step. That step is carried out anew, since
    contacts, forces and the like are no part of a state.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self._model, self._data, self._servos = model, data, data.ctrl
        # plugins and flexible bodies may have more to them than a state holds
        self._memory = None if model.nplugin or model.nflex else SharedMemory.current()
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
        """Return the values kept for this state of the physics and these inputs; None if there are none."""
        self._key = None
        if self._memory is None or not self._depends_on_state_alone():
            return None
        mujoco.mj_getState(self._model, self._data, self._start, _STATE)
        everything = b"".join((self._fingerprint.now(), self._start.tobytes(), inputs.tobytes()))
        self._key = hashlib.sha256(everything).digest()[: SharedMemory.key_size]
        kept = self._memory.get(self._key)
        return None if kept is None else np.frombuffer(kept)

    def _depends_on_state_alone(self) -> bool:
        """Return whether the state alone decides: no sleeping islands, callbacks, or replaced functions."""
        sleeps = self._model.opt.enableflags & _SLEEP
        return not sleeps and _is_native() and _ORIGINALS.are_unchanged(self, self._fingerprint)

    def keep(self, values: Array) -> None:
        """Keep values that follow from the state and inputs of the last `recall`."""
        if self._memory is not None and self._key is not None and self._depends_on_state_alone():
            self._memory.put(self._key, values.tobytes())

    def step(self, inputs: Array, before: Array) -> None:
        """Compute one tick; `before` becomes the state before its last step."""
        model, data, step, servos = self._model, self._data, mujoco.mj_step, self._servos
        for row in inputs[:-1]:
            servos[:] = row
            step(model, data)
        mujoco.mj_getState(model, data, before, MOVING)
        servos[:] = inputs[-1]
        step(model, data)

    def end(self, before: Array, inputs: Array) -> None:
        """Compute the last step of a tick, from the state before it."""
        mujoco.mj_setState(self._model, self._data, before, MOVING)
        self._servos[:] = inputs[-1]
        mujoco.mj_step(self._model, self._data)


def _measure_no_time() -> None:
    """Keep MuJoCo from timing each part of a step, which costs 5 % and is not used.

    Its bindings set the clock when they are imported, and cannot take it away again.
    """
    with suppress(OSError, ValueError):  # another build may keep it elsewhere, and only be slower
        library = ctypes.PyDLL(mujoco._functions.__file__)
        ctypes.c_void_p.in_dll(library, "mjcb_time").value = None


class _Pointers:
    """The callbacks and collision functions that MuJoCo holds; C code may set them without the bindings."""

    def __init__(self) -> None:
        self._callbacks: list[ctypes.c_void_p] = []
        self._collisions: Any = b""
        with suppress(OSError, ValueError):  # another build may keep it elsewhere: then nothing is known
            library = ctypes.PyDLL(mujoco._functions.__file__)
            self._callbacks = [ctypes.c_void_p.in_dll(library, f"mjcb_{name}") for name in _CALLBACKS]
            kinds = int(mujoco.mjtGeom.mjNGEOMTYPES)
            table = ctypes.c_void_p * (kinds * kinds)
            self._collisions = table.in_dll(library, "mjCOLLISIONFUNC")
        self._known = bytes(self._collisions)

    def are_original(self) -> bool:
        """Return whether there are no callbacks, and all collision functions are MuJoCo's own."""
        known = self._known
        return bool(known) and not any(map(_is_set, self._callbacks)) and bytes(self._collisions) == known


def _is_set(pointer: ctypes.c_void_p) -> bool:
    return pointer.value is not None


_measure_no_time()
_is_native = _Pointers().are_original
_OWN = (__name__, Fingerprint.__module__, SharedMemory.__module__)
#: what steps depend on
_ORIGINALS = CodeRecord(_OWN, (mujoco, np, hashlib))
