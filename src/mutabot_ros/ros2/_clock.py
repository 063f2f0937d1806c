"""The time of a node: waiting, calling something later, and clock jumps.

A node that follows ``/clock`` waits in that time. Where it stands still meanwhile, as in a cell whose time
passes only while something is done, the wait is over when as much of ours has passed: no wait is endless.
"""

from __future__ import annotations

import inspect
import threading
import time
from collections.abc import Awaitable, Callable
from importlib import import_module
from typing import Any

from mutabot.api.values import Names
from mutabot_ros._patches import Patches

from ._steps import Pause

_PERIOD = 0.002
_NANO = 1e9


class _ClockOffset:
    """The offset of this process's clocks, in nanoseconds."""

    by = 0

    def back(self) -> None:
        self.by = 0


_moved = _ClockOffset()


def hook(patches: Patches, messages: Names) -> None:
    """Hook the clocks of nodes."""
    clock: Any = import_module("rclpy.clock")
    steady = import_module("rclpy.clock_type").ClockType.STEADY_TIME

    def now(original: Any, ours: Any) -> Any:
        found = original(ours)
        if not _moved.by or found.clock_type == steady:
            return found
        return type(found)(nanoseconds=max(0, found.nanoseconds + _moved.by), clock_type=found.clock_type)

    patches.put(clock.Clock, "now", now)
    patches.then(_moved.back)


def jump(seconds: float) -> None:
    """Move the clocks of this process by seconds; negative values move them back."""
    _moved.by += round(seconds * _NANO)


def sleep(node: Any) -> Callable[[float], Awaitable[None]]:
    """Return how a plain call of a node waits."""

    async def slept(seconds: float) -> None:
        _wait(node, seconds)

    return slept


def pause(node: Any) -> Callable[[float], Awaitable[None]]:
    """Return how a coroutine of a node waits."""

    async def paused(seconds: float) -> None:
        await Pause(lambda action: later(node)(seconds, action))

    return paused


def later(node: Any) -> Callable[[float, Callable[[], object]], None]:
    """Return how a node calls something later: by its executor, if one spins it."""

    def done_later(seconds: float, action: Callable[[], object]) -> None:
        def wait() -> None:
            _wait(node, seconds)
            _do(node, action)

        threading.Thread(target=wait, daemon=True).start()

    return done_later


def send_later(node: Any) -> Callable[[float, Callable[[], object]], None]:
    """Return how a message of a node is sent later, also while the node does not spin."""

    def go_out(seconds: float, action: Callable[[], object]) -> None:
        def wait() -> None:
            _wait(node, seconds)
            action()

        threading.Thread(target=wait, daemon=True).start()

    return go_out


def _wait(node: Any, seconds: float) -> None:
    clock = node.get_clock() if node is not None else None
    if clock is None or not getattr(clock, "ros_time_is_active", False):
        time.sleep(seconds)
        return
    ours = time.monotonic() + seconds
    theirs = clock.now().nanoseconds + seconds * _NANO
    while time.monotonic() < ours and clock.now().nanoseconds < theirs:
        time.sleep(_PERIOD)


def _do(node: Any, action: Callable[[], object]) -> None:
    executor = node.executor if node is not None else None
    if executor is None:
        result = action()
        if not inspect.isawaitable(result):
            return

        async def rest() -> None:
            await result

        import_module("rclpy").get_global_executor().create_task(rest)
        return

    async def done() -> None:
        result = action()
        if inspect.isawaitable(result):
            await result

    executor.create_task(done)
