"""Quality of service, in the words that all middlewares use."""

from __future__ import annotations

import copy
from importlib import import_module
from typing import Any

_NANO = 1e9


def qualities(qos: Any) -> dict[str, Any] | None:
    """What a profile, or the depth of a queue that stands for one, says; None for neither.

    A deadline of 0 is none. Policies that the middleware is to choose keep their name.
    """
    profile = _profile(qos)
    if profile is None:
        return None
    deadline = profile.deadline.nanoseconds / _NANO
    return {
        "depth": profile.depth,
        "reliability": profile.reliability.name.lower(),
        "durability": profile.durability.name.lower(),
        "deadline": deadline if deadline < 1e9 else 0.0,  # "infinite" is 292 years
    }


def changed(qos: Any, changes: dict[str, Any]) -> Any:
    """A profile with other values; the very one if there are none."""
    if not changes:
        return qos
    rclpy_qos: Any = import_module("rclpy.qos")
    profile = copy.copy(_profile(qos))
    for name, value in changes.items():
        match name:
            case "depth":
                profile.depth = max(0, int(value))
            case "reliability":
                profile.reliability = rclpy_qos.ReliabilityPolicy[str(value).upper()]
            case "durability":
                profile.durability = rclpy_qos.DurabilityPolicy[str(value).upper()]
            case "deadline":
                profile.deadline = import_module("rclpy.duration").Duration(seconds=float(value))
    return profile


def _profile(qos: Any) -> Any:
    kind: Any = import_module("rclpy.qos").QoSProfile
    if isinstance(qos, int) and not isinstance(qos, bool):
        return kind(depth=qos)
    return qos if isinstance(qos, kind) else None
