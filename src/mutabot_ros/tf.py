"""Intercepts transforms that a node reads from tf2's buffer, in ROS 1 and ROS 2."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from mutabot.api.values import Form, MiddlewareControls, Names, Where

from ._patches import Patches

MODULE = "tf2_ros"


def hook(messages: Names) -> Callable[[], None]:
    """Intercept transforms; return a function that removes the hook."""
    patches = Patches()

    def look_up(
        original: Any, buffer: Any, target_frame: str, source_frame: str, *more: Any, **named: Any
    ) -> Any:
        node = _node()
        name = f"{target_frame.removeprefix('/')} → {source_frame.removeprefix('/')}"
        handler = messages.find(Form.TRANSFORM, name, node)
        if handler is None:
            return original(buffer, target_frame, source_frame, *more, **named)

        def read() -> Any:
            return original(buffer, target_frame, source_frame, *more, **named)

        async def lost() -> Any:
            tf2_ros: Any = sys.modules[MODULE]
            raise tf2_ros.LookupException(f"no transform {name} has come")

        return handler(read, buffer, (), {}, Where(node=node, means=MiddlewareControls(lost=lost)))

    patches.put(sys.modules[MODULE].Buffer, "lookup_transform", look_up)
    return patches.undo


def _node() -> str | None:
    rospy: Any = sys.modules.get("rospy")
    return rospy.get_name() if rospy is not None else None
