"""Intercepts the callbacks and clocks of disturbed ROS 2 nodes."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

from . import _clock, _nodes
from ._topics import as_called

#: topics of rclpy itself
_OWN = ("/clock", "/parameter_events", "/rosout")


def topic_of(subscription: Any) -> str | None:
    """Return the topic of a subscription; None for rclpy's own. Raises LookupError if it is destroyed."""
    topic: str = _ask_existing(lambda: subscription.topic_name)
    return None if _nodes.is_own() or topic in _OWN or subscription.raw else topic


def intercept(subscription: Any, deliver: Callable[[Any, Callable[[Any], Any]], Any]) -> None:
    """Intercept the callback of a subscription."""
    callback = subscription._callback  # as the program gave it

    def received(message: Any, *more: Any) -> Any:
        return deliver(message, lambda delivered: callback(delivered, *more))

    subscription.callback = as_called(callback, received)


def later(subscription: Any, seconds: float, action: Callable[[], object]) -> None:
    """Call something later, in the time of the subscription's node, by its executor."""
    _clock.later(_nodes.node_of(subscription))(seconds, action)


def name_of(node: Any) -> str:
    """Return the resolved name of a node. Raises LookupError if it is destroyed."""
    name: str = _ask_existing(node.get_fully_qualified_name)
    return name


def shift_clock(node: Any, read: Callable[[int], int]) -> None:
    """Let a node's clock show another time, in nanoseconds."""
    clock = node.get_clock()
    now = clock.now

    def shifted() -> Any:
        found = now()
        return type(found)(nanoseconds=read(found.nanoseconds), clock_type=found.clock_type)

    clock.now = shifted


def _ask_existing(ask: Callable[[], Any]) -> Any:
    """Ask something of an entity. Raises LookupError if it is destroyed, as one of an earlier test is."""
    try:
        return ask()
    except import_module("rclpy.exceptions").InvalidHandle as error:
        raise LookupError("the last one was destroyed") from error
