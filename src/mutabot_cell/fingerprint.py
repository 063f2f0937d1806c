"""A fingerprint of a model, which any code may change at any time."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import mujoco
import numpy as np

_PIECE = 1024
"""Bytes that are looked at together: a belt whose speed wanders changes a few numbers at each tick."""


class Fingerprint:
    """Tells models apart, bit by bit."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model = model
        size = mujoco.mj_sizeModel(model)
        count = -(-size // _PIECE)
        both = np.zeros((2, count * _PIECE), dtype=np.uint8)
        self._saved = both[0, :size]
        self._now, self._known = both.view(np.uint64).reshape(2, count, -1)
        self._digests = [b""] * count
        self._digest = b""

    def now(self) -> bytes:
        """Return the fingerprint of the model as it is now."""
        mujoco.mj_saveModel(self._model, None, self._saved)
        if not self._digest:
            self._read(range(len(self._now)))
        elif not np.array_equal(self._now, self._known):
            self._read(np.flatnonzero((self._now != self._known).any(axis=1)).tolist())
        return self._digest

    def _read(self, pieces: Iterable[int]) -> None:
        for number in pieces:
            self._known[number] = self._now[number]
            self._digests[number] = hashlib.sha256(self._now[number].tobytes()).digest()
        self._digest = hashlib.sha256(b"".join(self._digests)).digest()
