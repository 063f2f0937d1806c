"""ROS 2: what nodes do through rclpy.

One file per thing that a node has: topics, services, actions, parameters, times. Names are the resolved ones,
which rclpy knows once a publisher, subscription or client is there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from mutabot.inside.ros._patches import Patches
from mutabot.inside.targets.messages import Messages
from mutabot.inside.targets.target import Finding
from mutabot.model import Operation

from . import _actions, _clock, _nodes, _parameters, _services, _times, _topics
from ._types import look_at, seen

MODULE = "rclpy"

_PARTS = (_nodes, _topics, _services, _actions, _parameters, _times, _clock)


def hook(messages: Messages) -> Callable[[], None]:
    """Let what nodes of this process do pass by; returns what takes the hooks away."""
    patches = Patches()
    for part in _PARTS:
        part.hook(patches, messages)
    patches.then(seen.clear)
    return patches.undo


def check(operation: Operation) -> Iterator[Finding]:
    """What of an operation does not fit the installed definition of its type, or the one the program uses."""
    return look_at(operation)
