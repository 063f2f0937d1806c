"""Stamps of messages: moments in whole seconds and nanoseconds, as one number of seconds.

A stamp of ROS 2 has ``sec`` and ``nanosec``, one of ROS 1 ``secs`` and ``nsecs``. Of a number of seconds
since 1970 some hundred nanoseconds are lost, so a stamp is written anew only where it is to be another one.
"""

from __future__ import annotations

import copy
from typing import Any

_PARTS = (("sec", "nanosec"), ("secs", "nsecs"))
_NANO = 1_000_000_000


def seconds_of(stamp: Any) -> float | None:
    """The seconds of a stamp, or of a number that is one; None for anything else."""
    if isinstance(stamp, int | float) and not isinstance(stamp, bool):
        return float(stamp)
    for whole, rest in _PARTS:
        if hasattr(stamp, whole) and hasattr(stamp, rest):
            return float(getattr(stamp, whole) + getattr(stamp, rest) / _NANO)
    return None


def with_seconds(stamp: Any, seconds: float) -> Any:
    """A copy of a stamp that says so many seconds; none says less than zero."""
    whole, rest = divmod(max(0, round(seconds * _NANO)), _NANO)
    for names in _PARTS:
        if all(hasattr(stamp, name) for name in names):
            copied = copy.copy(stamp)
            setattr(copied, names[0], whole)
            setattr(copied, names[1], rest)
            return copied
    return float(seconds)
