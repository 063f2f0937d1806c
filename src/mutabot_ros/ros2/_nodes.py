"""Nodes of ROS 2: the entities that belong to each, and the sites of their calls."""

from __future__ import annotations

import threading
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from types import CodeType
from typing import Any

import ros_in_process
from mutabot.api.values import MiddlewareControls, Names, Where
from mutabot_ros._patches import Patches

from . import _clock

#: what we keep on nodes and on what belongs to them
_NAME, _NODE = "_mutabot_name", "_mutabot_node"


class _ThreadState(threading.local):
    """State of a thread: whether it creates entities of rclpy itself or of a node."""

    making = 0
    node: Any = None


_now = _ThreadState()


def hook(patches: Patches, messages: Names) -> None:
    """Record nodes as they are created."""
    patches.put(import_module("rclpy.node").Node, "__init__", partial(_made, messages))


def _made(messages: Names, original: Any, node: Any, *args: Any, **kwargs: Any) -> None:
    with own():
        original(node, *args, **kwargs)
    messages.note_node(node.get_fully_qualified_name())


@contextmanager
def own() -> Iterator[None]:
    """Context in which entities that are created belong to rclpy itself."""
    _now.making += 1
    try:
        yield
    finally:
        _now.making -= 1


def is_own() -> bool:
    """Return whether entities created now belong to rclpy itself: parts of a node, or of a wait."""
    return _now.making > 0


@contextmanager
def of(node: Any) -> Iterator[None]:
    """Context in which entities that are created belong to a node."""
    before, _now.node = _now.node, node
    try:
        yield
    finally:
        _now.node = before


def claim(thing: Any, node: Any = None) -> None:
    """Record the node to which an entity belongs: this one, or the one that is creating it."""
    found = node if node is not None else _now.node
    if found is not None:
        setattr(thing, _NODE, found)


def node_of(thing: Any) -> Any:
    """Return the node to which something belongs; None if it is unknown."""
    return getattr(thing, _NODE, None)


def name_of(node: Any) -> str | None:
    """Return the resolved name of a node; None without a node."""
    if node is None:
        return None
    found: str | None = getattr(node, _NAME, None)
    if found is None:
        found = node.get_fully_qualified_name()
        setattr(node, _NAME, found)
    return found


def topic_of(thing: Any, ask: Callable[[], str]) -> str:
    """Return the resolved name of a publisher, subscription or client; it is cached."""
    found: str | None = getattr(thing, _NAME, None)
    if found is None:
        found = ask()
        setattr(thing, _NAME, found)
    return found


def where(
    node: Any,
    code: CodeType | None = None,
    *,
    is_async: bool = False,
    lost: Callable[[], Awaitable[Any]] | None = None,
    cancel: Callable[[Any], Awaitable[None]] | None = None,
) -> Where:
    """Return the site of a node's call and the faults that can act on it.

    Args:
        node: the node; None if it is not known.
        code: the function that is called back.
        is_async: whether the call is a coroutine's.
        lost, cancel: as in ``MiddlewareControls``.
    """
    sleep = _clock.pause(node) if is_async else _clock.sleep(node)
    means = MiddlewareControls(
        sleep,
        _clock.later(node),
        lost,
        cancel,
        _clock.jump,
        _clock.send_later(node),
        end=ros_in_process.end_of_process(),
    )
    return Where(code, name_of(node), means)
