"""Disturbances of what nodes of ROS 2 hear, and of their clocks: what `ros2.toml` of this package names.

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

from . import _clock, _nodes
from ._topics import as_called

Changed: TypeAlias = Callable[[float], float]
Acts: TypeAlias = Callable[[], None]
#: what a callback gets of a message: what it is called with, now or later; or nothing
_Deliver: TypeAlias = Callable[[Any, Callable[[Any], Any]], Any]
#: topics of rclpy itself
_OWN = ("/clock", "/parameter_events", "/rosout")
_NANO = 1e9


def bias(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts, axis: str) -> None:
    """Where messages of topics say that something is along an axis, m: points, poses, transforms."""

    def biased(message: Any) -> bool:
        places = list(_places(message))
        for place in places:
            setattr(place, axis, float(change(getattr(place, axis))))
        return bool(places)

    _listen(subscription, names, _changing(biased, acts))


def frame_position(
    subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts, axis: str
) -> None:
    """Where frames are along an axis of their parents, m: in messages with transforms to them."""

    def moved(message: Any) -> bool:
        found = list(_transforms(message, names))
        for one in found:
            setattr(one.translation, axis, float(change(getattr(one.translation, axis))))
        return bool(found)

    _listen(subscription, "*", _changing(moved, acts))


def frame_angle(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """How frames are turned about the vertical of their parents, rad: in messages with transforms to them."""
    half = change(0.0) / 2

    def turned(message: Any) -> bool:
        found = list(_transforms(message, names))
        for one in found:
            q, cos, sin = one.rotation, math.cos(half), math.sin(half)
            q.w, q.x, q.y, q.z = (
                cos * q.w - sin * q.z, cos * q.x - sin * q.y, cos * q.y + sin * q.x, cos * q.z + sin * q.w,
            )  # fmt: skip
        return bool(found)

    _listen(subscription, "*", _changing(turned, acts))


def distance(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """What messages of topics say of distances, m: `range`, or all that are finite of `ranges`."""

    def read(message: Any) -> bool:
        if hasattr(message, "range"):
            message.range = float(change(message.range))
        elif hasattr(message, "ranges"):
            message.ranges = [float(change(one)) if math.isfinite(one) else one for one in message.ranges]
        return hasattr(message, "range") or hasattr(message, "ranges")

    _listen(subscription, names, _changing(read, acts))


def delay(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """By how much later messages of topics come, s, in the node's time."""

    def late(message: Any, deliver: Callable[[Any], Any]) -> None:
        acts()
        _clock.later(_nodes.node_of(subscription))(change(0.0), lambda: deliver(message))

    _listen(subscription, names, late)


def loss(subscription: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """Share of the messages of topics that never come."""

    def lost(message: Any, deliver: Callable[[Any], Any]) -> Any:
        if random.random() >= change(0.0):
            return deliver(message)
        acts()
        return None

    _listen(subscription, names, lost)


def clock_offset(node: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """By how much the clocks of nodes are ahead of others, s."""
    _run_apart(node, names, acts, lambda nanoseconds: nanoseconds + change(0.0) * _NANO)


def clock_rate(node: Any, change: Changed, *, names: str, random: Random, acts: Acts) -> None:
    """How fast the clocks of nodes run, as a part of other clocks, from when the node is made."""
    begin = _of_living(node.get_clock().now).nanoseconds
    _run_apart(node, names, acts, lambda nanoseconds: begin + change(1.0) * (nanoseconds - begin))


def _listen(subscription: Any, names: str, deliver: _Deliver) -> None:
    """Let something stand before the callback of a subscription. Raises LookupError for other topics."""
    topic = _of_living(lambda: subscription.topic_name)
    if _nodes.is_own() or topic in _OWN or subscription.raw or not fnmatchcase(topic, names):
        raise LookupError(f"nothing listens to a topic {names!r}; the last one is {topic}")
    callback = subscription._callback  # as the program gave it

    def received(message: Any, *more: Any) -> Any:
        return deliver(message, lambda one: callback(one, *more))

    subscription.callback = as_called(callback, received)


def _of_living(ask: Callable[[], Any]) -> Any:
    """Ask something of an entity. Raises LookupError for one that is destroyed, as of an earlier test."""
    try:
        return ask()
    except import_module("rclpy.exceptions").InvalidHandle as error:
        raise LookupError("the last one was destroyed") from error


def _changing(change: Callable[[Any], bool], acts: Acts) -> _Deliver:
    """Deliver a changed copy; `change` says whether it has changed anything."""

    def deliver(message: Any, callback: Callable[[Any], Any]) -> Any:
        copied = copy.deepcopy(message)
        if not change(copied):
            return callback(message)
        acts()
        return callback(copied)

    return deliver


def _places(message: Any) -> Iterator[Any]:
    """Yield what says where something is: a point or a vector, wherever it lies in a message."""
    for name in ("pose", "position", "point", "transform", "translation"):
        if (part := getattr(message, name, None)) is not None:
            yield from _places(part)
    for one in getattr(message, "transforms", ()):
        yield from _places(one)
    if all(isinstance(getattr(message, axis, None), float) for axis in "xyz") and not hasattr(message, "w"):
        yield message


def _transforms(message: Any, names: str) -> Iterator[Any]:
    """Yield the transforms of a message to frames of these names."""
    for one in getattr(message, "transforms", (message,)):
        if hasattr(one, "transform") and fnmatchcase(getattr(one, "child_frame_id", ""), names):
            yield one.transform


def _run_apart(node: Any, names: str, acts: Acts, read: Callable[[int], float]) -> None:
    name = _of_living(node.get_fully_qualified_name)
    if not fnmatchcase(name, names):
        raise LookupError(f"no node is named {names!r}; the last one is {name}")
    clock = node.get_clock()
    now = clock.now

    def told() -> Any:
        found = now()
        acts()
        return type(found)(nanoseconds=max(0, round(read(found.nanoseconds))), clock_type=found.clock_type)

    clock.now = told
