"""Lets parts at rest cost no time, for scenes with many parts: MuJoCo's sleeping islands."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import mujoco

MANY = 4
"""From this many parts on, parts are solved island by island, and islands at rest sleep.

Fewer parts are solved together, as in earlier versions, whose runs stay bit-identical. The Jacobian stays
dense: a sparse one gains a third while 27 parts move in one heap, but MuJoCo 4.0.0 factorises it wrongly (its
issue 3767, repaired in 4.0.1).
"""
SLOWEST = 1e-3
"""Speed below which an island falls asleep after ten steps, m/s: MuJoCo's own value."""

_SLEEP = int(mujoco.mjtEnableBit.mjENBL_SLEEP)


def let_sleep(spec: mujoco.MjSpec) -> None:
    """Let parts at rest sleep until something touches them."""
    spec.option.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_ISLAND)
    spec.option.enableflags |= _SLEEP
    spec.option.sleep_tolerance = SLOWEST


@contextmanager
def awake(model: mujoco.MjModel) -> Iterator[None]:
    """Let nothing sleep in this context, and recompute the poses of fixtures."""
    flags = model.opt.enableflags
    model.opt.enableflags = flags & ~_SLEEP
    try:
        yield
    finally:
        model.opt.enableflags = flags
