"""A node of ROS 1: its name, its names, its clock, and the arguments it gives."""

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
    """Resolved name of the node of this process."""
    found: str = sys.modules[_MODULE].get_name()
    return found


def resolved(given: Any) -> str | None:
    """A name as the master knows it; None for one that rospy will refuse."""
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
    """The message or request that the arguments of a call make; raises what rospy raises."""
    return sys.modules[_MODULE].msg.args_kwds_to_message(kind, args, kwargs)


def with_sender(copied: Any, message: Any) -> Any:
    """A copy of a message that says who sent it, which rospy does not copy, and tf2 asks for."""
    if (header := getattr(message, "_connection_header", None)) is not None:
        copied._connection_header = header
    return copied


class Given:
    """The arguments of a call of rospy, by name.

    Args:
        signature: of what is called.
        args, kwargs: as the program gave them.
    """

    def __init__(self, signature: inspect.Signature, args: tuple[Any, ...], kwargs: dict[str, Any]) -> None:
        self._bound = signature.bind(*args, **kwargs)

    def get(self, argument: str) -> Any:
        """An argument; None if it is not given."""
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
        """What is given by position."""
        return self._bound.args

    @property
    def kwargs(self) -> dict[str, Any]:
        """What is given by name."""
        return self._bound.kwargs


def bound(function: Callable[..., Any], *args: Any, **kwargs: Any) -> Given:
    """The arguments of a call; raises TypeError, as the call would, if they do not fit."""
    return Given(_signature(function), args, kwargs)


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
    """Have something done later, in ROS's time; not at all once the node is shut down."""

    def wait() -> None:
        rospy: Any = sys.modules[_MODULE]
        try:
            rospy.sleep(seconds)
        except rospy.ROSException:  # the node is shut down: nobody is there any more
            return
        action()

    threading.Thread(target=wait, daemon=True).start()


class NodeClock:
    """What a node takes for the time, which may be moved."""

    def __init__(self) -> None:
        self._moved = 0.0

    def jump(self, seconds: float) -> None:
        """Move it; negative is back."""
        self._moved += seconds

    def hook(self, patches: Patches, rospy: Any) -> None:
        """Stand around rospy's own clock."""
        for module in (rospy.rostime, rospy):
            patches.put(module, "get_rostime", self._now)
        patches.then(self._back)

    def _now(self, original: Any) -> Any:
        now = original()
        return type(now).from_sec(max(0.0, now.to_sec() + self._moved)) if self._moved else now

    def _back(self) -> None:
        self._moved = 0.0


clock = NodeClock()
