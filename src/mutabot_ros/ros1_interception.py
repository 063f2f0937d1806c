"""Intercepts the callbacks and clocks of disturbed ROS 1 nodes.

A subscription is what rospy shares among all subscribers of a topic in a process. A node is its process.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from . import _ros1_node as node
from .ros1 import MODULE, OWN_TOPICS


def topic_of(subscription: Any) -> str | None:
    """Return the topic of a subscription; None for rospy's own. Raises LookupError if it is closed."""
    if subscription.closed:
        raise LookupError("the last one was closed")
    topic: str = subscription.resolved_name
    return None if topic in OWN_TOPICS else topic


def intercept(subscription: Any, deliver: Callable[[Any, Callable[[Any], Any]], Any]) -> None:
    """Intercept the callbacks of a subscription."""

    def invoked(message: Any, callback: Any, more: Any) -> None:
        deliver(
            message,
            lambda received: type(subscription)._invoke_callback(subscription, received, callback, more),
        )

    subscription._invoke_callback = invoked


def later(subscription: Any, seconds: float, action: Callable[[], object]) -> None:
    """Call something later, in the node's time."""
    node.later(seconds, action)


def name_of(handler: Any) -> str:
    """Return the resolved name of a node."""
    name: str = handler.name
    return name


def shift_clock(handler: Any, read: Callable[[int], int]) -> None:
    """Let a node's clock show another time, in nanoseconds."""
    rospy: Any = sys.modules[MODULE]
    now = rospy.rostime.get_rostime

    def shifted() -> Any:
        found = now()
        return type(found)(nsecs=read(found.to_nsec()))

    for module in (rospy.rostime, rospy):
        module.get_rostime = shifted
