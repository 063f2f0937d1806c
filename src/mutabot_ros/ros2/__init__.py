"""ROS 2: intercepts what nodes do through rclpy.

One file per thing that a node has: topics, services, actions, parameters, times. Names are the resolved ones,
which rclpy knows once a publisher, subscription or client is there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from mutabot.api.values import Finding, Names, Operation
from mutabot_ros._patches import Patches

from ._actions import hook as hook_actions
from ._clock import hook as hook_clock
from ._nodes import hook as hook_nodes
from ._parameters import hook as hook_parameters
from ._services import hook as hook_services
from ._timers import hook as hook_times
from ._topics import hook as hook_topics
from ._types import TYPES

MODULE = "rclpy"

_HOOKS = (hook_nodes, hook_topics, hook_services, hook_actions, hook_parameters, hook_times, hook_clock)


def hook(messages: Names) -> Callable[[], None]:
    """Intercept what the nodes of this process do; return a function that removes the hooks."""
    patches = Patches()
    for put in _HOOKS:
        put(patches, messages)
    patches.then(TYPES.clear)
    return patches.undo


def check(operation: Operation) -> Iterator[Finding]:
    """Yield what in an operation does not fit the installed definition of its type, or the program's type."""
    return TYPES.check(operation)
