"""Futures that are never done: what a command that is lost answers where the original answered a future."""

from __future__ import annotations

import asyncio
import concurrent.futures
import sys
from collections.abc import Mapping
from typing import Any

_RCLPY = "rclpy.task"


def future_class(value: Any) -> str | None:
    """The kind of future that a value is; None if it is none."""
    rclpy: Any = sys.modules.get(_RCLPY)
    if isinstance(value, asyncio.Task):
        return "asyncio.Task"
    if isinstance(value, asyncio.Future):
        return "asyncio.Future"
    if type(value) is concurrent.futures.Future:
        return "concurrent.futures.Future"
    return "rclpy.task.Future" if rclpy is not None and type(value) is rclpy.Future else None


def never_done(kind: str, here: Mapping[str, Any]) -> Any:
    """A new future of this kind that nobody ever completes. Raises LookupError where there can be none."""
    if kind == "concurrent.futures.Future":
        return concurrent.futures.Future()
    if kind == "rclpy.task.Future":
        rclpy: Any = sys.modules.get(_RCLPY)
        if rclpy is None:
            raise LookupError(f"{_RCLPY} is not imported")
        return rclpy.Future()
    try:
        loop = asyncio.get_running_loop()
    except RuntimeError:
        raise LookupError(f"a future of kind {kind} needs an event loop, and none is running") from None
    return loop.create_task(_never()) if kind == "asyncio.Task" else loop.create_future()


async def _never() -> None:
    await asyncio.get_running_loop().create_future()
