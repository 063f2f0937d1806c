"""A ROS 1 node: its name, its resolved names, its clock, and the arguments of its calls."""

from __future__ import annotations

import functools
import inspect
import sys
import threading
from collections.abc import Awaitable, Callable
from types import CodeType
from typing import Any

from mutabot.api.values import MiddlewareControls, Where

from ._patches import Patches

_MODULE = "rospy"


def name() -> str:
    """Return the resolved name of this process's node."""
    found: str = sys.modules[_MODULE].get_name()
    return found


def resolved(given: Any) -> str | None:
    """Return a name as the master knows it; None if rospy will refuse it."""
    rospy: Any = sys.modules[_MODULE]
    try:
        if rospy.core.is_initialized():
            found: str = rospy.names.resolve_name(given)
        else:
            found = rospy.names.resolve_name_without_node_name(given)
    except Exception:  # rospy says what is wrong with it, in its own way
        return None
    return found


def message_of(kind: Any, args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
    """Return the message or request that a call's arguments make. Raises what rospy raises."""
    return sys.modules[_MODULE].msg.args_kwds_to_message(kind, args, kwargs)


def with_sender(copied: Any, message: Any) -> Any:
    """Return the copy of a message with its sender, which rospy does not copy and tf2 needs."""
    if (header := getattr(message, "_connection_header", None)) is not None:
        copied._connection_header = header
    return copied


class CallArguments:
    """The arguments of a call of rospy, by name.

    Args:
        signature: of what is called.
        args, kwargs: as the program gave them.
    """

    def __init__(self, signature: inspect.Signature, args: tuple[Any, ...], kwargs: dict[str, Any]) -> None:
        self._bound = signature.bind(*args, **kwargs)

    def get(self, argument: str) -> Any:
        """Return an argument; None if it is not given."""
        return self._bound.arguments.get(argument)

    def change(self, **values: Any) -> None:
        """Replace arguments; ``...`` leaves one unchanged."""
        self._bound.arguments.update((key, value) for key, value in values.items() if value is not ...)

    def settings(self, **names: str) -> dict[str, Any]:
        """Return the settings that are given, by the names that all middlewares use."""
        given = self._bound.arguments
        return {ours: given[theirs] for ours, theirs in names.items() if given.get(theirs) is not None}

    @property
    def args(self) -> tuple[Any, ...]:
        """The positional arguments."""
        return self._bound.args

    @property
    def kwargs(self) -> dict[str, Any]:
        """The keyword arguments."""
        return self._bound.kwargs


def bound(function: Callable[..., Any], *args: Any, **kwargs: Any) -> CallArguments:
    """Return the arguments of a call. Raises TypeError, as the call would, if they do not fit."""
    return CallArguments(_signature(function), args, kwargs)


@functools.cache
def _signature(function: Callable[..., Any]) -> inspect.Signature:
    return inspect.signature(function)


def where(
    code: CodeType | None = None,
    lost: Callable[[], Awaitable[Any]] | None = None,
    cancel: Callable[[Any], Awaitable[None]] | None = None,
) -> Where:
    """Return the site of a call and the faults that can act on it."""
    return Where(code, name(), MiddlewareControls(_sleep, later, lost, cancel, clock.jump, later))


async def _sleep(seconds: float) -> None:
    sys.modules[_MODULE].sleep(seconds)


def later(seconds: float, action: Callable[[], object]) -> None:
    """Call something later, in ROS time; not at all if the node has been shut down."""

    def wait() -> None:
        rospy: Any = sys.modules[_MODULE]
        try:
            rospy.sleep(seconds)
        except rospy.ROSException:  # the node is shut down
            return
        action()

    threading.Thread(target=wait, daemon=True).start()


class NodeClock:
    """The offset of a node's clock."""

    def __init__(self) -> None:
        self._moved = 0.0

    def jump(self, seconds: float) -> None:
        """Move the clock by seconds; negative values move it back."""
        self._moved += seconds

    def hook(self, patches: Patches, rospy: Any) -> None:
        """Replace rospy's own clock."""
        for module in (rospy.rostime, rospy):
            patches.put(module, "get_rostime", self._now)
        patches.then(self._back)

    def _now(self, original: Any) -> Any:
        now = original()
        return type(now).from_sec(max(0.0, now.to_sec() + self._moved)) if self._moved else now

    def _back(self) -> None:
        self._moved = 0.0


clock = NodeClock()
