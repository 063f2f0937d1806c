"""Clocks that tests cannot replace.

Tests replace ``time.monotonic`` and its like, in all modules that have taken them by name, or what these do.
None of it reaches these: they are bound when the first of ours is imported, are equal to none of those
functions, and ask the system for a clock that cannot be faked.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

_clock = time.clock_gettime

#: seconds of the clock that all processes share
monotonic: Callable[[], float] = partial(_clock, time.CLOCK_MONOTONIC)
#: seconds of processor time of this process
process_time: Callable[[], float] = partial(_clock, time.CLOCK_PROCESS_CPUTIME_ID)
#: seconds of processor time of this thread
thread_time: Callable[[], float] = partial(_clock, time.CLOCK_THREAD_CPUTIME_ID)
sleep: Callable[[float], None] = partial(time.sleep)
