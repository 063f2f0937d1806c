"""Disturbances of the messages and clocks of ROS nodes: the functions that `ros1.toml` and `ros2.toml` name.

Each is a function of a subscription, or of a node, as it was made, and of the change, which says what becomes
of a number in SI units; and, by name, of `names` (topics, frames or nodes), `random`, `acts`, which is to be
called whenever something is changed, and options. Each raises LookupError if the names mean something else.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator
from fnmatch import fnmatchcase
from importlib import import_module
from random import Random
from typing import Any, TypeAlias

from ._ros1_node import with_sender

Changed: TypeAlias = Callable[[float], float]
Acts: TypeAlias = Callable[[], None]
#: what a callback gets of a message: what it is called with, now or later; or nothing
_Deliver: TypeAlias = Callable[[Any, Callable[[Any], Any]], Any]
#: what stands before callbacks and clocks, by the client library that a world is of
_INTERCEPTION = {"rclpy": "mutabot_ros.ros2.interception", "rospy": "mutabot_ros.ros1_interception"}
_NANO = 1e9


def bias(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts, axis: str) -> None:
    """Shift positions in messages of topics along an axis, m: points, poses, transforms."""

    def biased(message: Any) -> bool:
        places = list(_positions(message))
        for place in places:
            setattr(place, axis, float(change(getattr(place, axis))))
        return bool(places)

    _intercept(subscription, names, _changing(biased, acts))


def frame_position(
    subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts, axis: str
) -> None:
    """Shift frames along an axis of their parents, m, in messages with transforms to them."""

    def moved(message: Any) -> bool:
        found = [
            stamped_transform.transform
            for stamped_transform in _stamped_transforms(message)
            if _is_to(stamped_transform, names)
        ]
        for transform in found:
            setattr(transform.translation, axis, float(change(getattr(transform.translation, axis))))
        return bool(found)

    _intercept(subscription, "*", _changing(moved, acts))


def frame_angle(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """Turn frames about the vertical axis of their parents, rad, in messages with transforms to them."""
    half = change(0.0) / 2

    def turned(message: Any) -> bool:
        found = [
            stamped_transform.transform
            for stamped_transform in _stamped_transforms(message)
            if _is_to(stamped_transform, names)
        ]
        for transform in found:
            q, cos, sin = transform.rotation, math.cos(half), math.sin(half)
            q.w, q.x, q.y, q.z = (
                cos * q.w - sin * q.z, cos * q.x - sin * q.y, cos * q.y + sin * q.x, cos * q.z + sin * q.w,
            )  # fmt: skip
        return bool(found)

    _intercept(subscription, "*", _changing(turned, acts))


def frame_delay(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """Delay transforms to frames, s, in the node's time, but not other transforms in a message."""

    def late(message: Any, deliver: Callable[[Any], Any]) -> Any:
        meant, others = _split_message(message, names)
        if meant is not None:
            acts()
            _library(subscription).later(subscription, change(0.0), lambda: deliver(meant))
        return deliver(others) if others is not None else None

    _intercept(subscription, "*", late)


def frame_loss(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """Drop a share of the messages' transforms to frames, but not other transforms in a message."""

    def lost(message: Any, deliver: Callable[[Any], Any]) -> Any:
        meant, others = _split_message(message, names)
        if meant is None or random.random() >= change(0.0):
            return deliver(message)
        acts()
        return deliver(others) if others is not None else None

    _intercept(subscription, "*", lost)


def distance(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """Change distances in messages of topics, m: `range`, or all finite values of `ranges`."""

    def read(message: Any) -> bool:
        if hasattr(message, "range"):
            message.range = float(change(message.range))
        elif hasattr(message, "ranges"):
            message.ranges = [
                float(change(reading)) if math.isfinite(reading) else reading for reading in message.ranges
            ]
        return hasattr(message, "range") or hasattr(message, "ranges")

    _intercept(subscription, names, _changing(read, acts))


def delay(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """Delay messages of topics, s, in the node's time."""

    def late(message: Any, deliver: Callable[[Any], Any]) -> None:
        acts()
        _library(subscription).later(subscription, change(0.0), lambda: deliver(message))

    _intercept(subscription, names, late)


def loss(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """Drop a share of the messages of topics."""

    def lost(message: Any, deliver: Callable[[Any], Any]) -> Any:
        if random.random() >= change(0.0):
            return deliver(message)
        acts()
        return None

    _intercept(subscription, names, lost)


def clock_offset(node: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """Set the clocks of nodes ahead of others, s."""
    _shift_clock(node, names, acts, lambda nanoseconds: nanoseconds + change(0.0) * _NANO)


def clock_rate(node: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """Change the rate of nodes' clocks, relative to others, from when they are first read."""
    begin = list[int]()

    def read(nanoseconds: int) -> float:
        begin.append(nanoseconds)
        del begin[1:]
        return begin[0] + change(1.0) * (nanoseconds - begin[0])

    _shift_clock(node, names, acts, read)


def _library(world: Any) -> Any:
    """Return the module that intercepts callbacks and clocks of a world's client library."""
    return import_module(_INTERCEPTION[type(world).__module__.partition(".")[0]])


def _intercept(subscription: Any, names: str, deliver: _Deliver) -> None:
    """Intercept the callbacks of a subscription. Raises LookupError for other topics."""
    library = _library(subscription)
    topic = library.topic_of(subscription)
    if topic is None or not fnmatchcase(topic, names):
        raise LookupError(f"nothing listens to a topic {names!r}; the last one is {topic or 'of ROS itself'}")
    library.intercept(subscription, deliver)


def _shift_clock(node: Any, names: str, acts: Acts, read: Callable[[int], float]) -> None:
    library = _library(node)
    name = library.name_of(node)
    if not fnmatchcase(name, names):
        raise LookupError(f"no node is named {names!r}; the last one is {name}")

    def shifted(nanoseconds: int) -> int:
        acts()
        return max(0, round(read(nanoseconds)))

    library.shift_clock(node, shifted)


def _changing(change: Callable[[Any], bool], acts: Acts) -> _Deliver:
    """Return a function that delivers a changed copy; `change` says whether it has changed anything."""

    def deliver(message: Any, callback: Callable[[Any], Any]) -> Any:
        copied = with_sender(copy.deepcopy(message), message)
        if not change(copied):
            return callback(message)
        acts()
        return callback(copied)

    return deliver


def _positions(message: Any) -> Iterator[Any]:
    """Yield the positions in a message: points or vectors, however deeply nested."""
    for name in ("pose", "position", "point", "transform", "translation"):
        if (part := getattr(message, name, None)) is not None:
            yield from _positions(part)
    for transform in getattr(message, "transforms", ()):
        yield from _positions(transform)
    if all(isinstance(getattr(message, axis, None), float) for axis in "xyz") and not hasattr(message, "w"):
        yield message


def _stamped_transforms(message: Any) -> list[Any]:
    """Return the stamped transforms that a message contains or is."""
    found = getattr(message, "transforms", (message,))
    return [
        transform
        for transform in found
        if hasattr(transform, "transform") and hasattr(transform, "child_frame_id")
    ]


def _is_to(transform: Any, names: str) -> bool:
    return fnmatchcase(transform.child_frame_id.removeprefix("/"), names)


def _split_message(message: Any, names: str) -> tuple[Any, Any]:
    """Split a message: transforms to frames of these names, and the others; None for an empty part."""
    meant = [transform for transform in _stamped_transforms(message) if _is_to(transform, names)]
    others = [transform for transform in _stamped_transforms(message) if not _is_to(transform, names)]
    if not meant or not others:
        return (message, None) if meant else (None, message)
    parts = [with_sender(copy.copy(message), message) for _ in range(2)]
    for part, transforms in zip(parts, (meant, others), strict=True):
        part.transforms = transforms
    return parts[0], parts[1]
