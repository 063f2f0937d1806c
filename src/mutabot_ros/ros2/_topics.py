"""Intercepts topics of ROS 2: publishers and subscriptions, with their quality of service."""

from __future__ import annotations

import copy
import functools
import inspect
import time
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from typing import Any

from mutabot.api.values import Form, Names
from mutabot_ros._patches import Patches, code_of
from mutabot_ros.ros2 import _nodes

from ._types import TYPES

_WRAPPED = "_mutabot_wrapped"


def hook(patches: Patches, messages: Names) -> None:
    """Hook publishers and subscriptions."""
    node: Any = import_module("rclpy.node").Node
    topics = _Topics(messages)
    patches.put(node, "create_publisher", topics.advertise)
    patches.put(node, "create_subscription", topics.subscribe)
    patches.put(import_module("rclpy.publisher").Publisher, "publish", topics.publish)
    patches.put(import_module("rclpy.wait_for_message"), "wait_for_message", topics.wait)
    _hook_callback(patches, import_module("rclpy.subscription").Subscription, topics)


def _hook_callback(patches: Patches, kind: Any, topics: _Topics) -> None:
    """Keep callbacks as the program gave them, but let executors call ours."""
    original = kind.callback

    def set_callback(subscription: Any, callback: Any) -> None:
        _nodes.claim(subscription)
        original.fset(subscription, callback)

    def get_callback(subscription: Any) -> Any:
        return topics.around(subscription, original.fget(subscription))

    kind.callback = property(get_callback, set_callback, doc=original.__doc__)
    patches.then(lambda: setattr(kind, "callback", original))


class _Topics:
    def __init__(self, messages: Names) -> None:
        self._messages = messages

    def advertise(
        self, original: Any, node: Any, msg_type: Any, topic: Any, qos_profile: Any, **kwargs: Any
    ) -> Any:
        if _nodes.is_own():
            return original(node, msg_type, topic, qos_profile, **kwargs)

        def made(name: Any, profile: Any) -> Any:
            publisher = original(node, msg_type, name, profile, **kwargs)
            _nodes.claim(publisher, node)
            return publisher

        return self._set_up((Form.ADVERTISE, Form.PUBLISH), made, node, msg_type, topic, qos_profile)

    def subscribe(
        self,
        original: Any,
        node: Any,
        msg_type: Any,
        topic: Any,
        callback: Any,
        qos_profile: Any,
        **kwargs: Any,
    ) -> Any:
        if _nodes.is_own():
            return original(node, msg_type, topic, callback, qos_profile, **kwargs)

        def made(name: Any, profile: Any) -> Any:
            with _nodes.of(node):
                return original(node, msg_type, name, callback, profile, **kwargs)

        return self._set_up((Form.SUBSCRIBE, Form.RECEIVE), made, node, msg_type, topic, qos_profile)

    def _set_up(
        self,
        forms: tuple[Form, Form],
        make: Callable[[Any, Any], Any],
        node: Any,
        kind: Any,
        topic: Any,
        qos_profile: Any,
    ) -> Any:
        """Make a publisher or subscription of a node.

        Args:
            forms: what sets it up, and what it is for.
            make: makes it, with a name and a profile.
            node, kind, topic, qos_profile: as the program gave them.
        """
        form, use = forms
        try:
            name = node.resolve_topic_name(topic)
        except Exception:  # rclpy says what is wrong with it, in its own way
            return make(topic, qos_profile)
        TYPES.note(use, name, kind)
        handler = self._messages.find(form, name, _nodes.name_of(node))
        given = qualities(qos_profile) if handler is not None else None
        if handler is None or given is None:
            return make(topic, qos_profile)

        def set_up(name: Any, depth: Any, reliability: Any, durability: Any, deadline: Any) -> Any:
            values = (depth, reliability, durability, deadline)
            wanted = zip(("depth", "reliability", "durability", "deadline"), values, strict=True)
            differing = {quality: value for quality, value in wanted if value != given[quality]}
            return make(name, changed(qos_profile, differing))

        return handler(set_up, None, (), {"name": topic, **given}, _nodes.where(node))

    def publish(self, original: Any, publisher: Any, msg: Any) -> Any:
        node = _nodes.node_of(publisher)
        if node is None or not isinstance(msg, publisher.msg_type):  # rclpy's own, bytes, or a mistake
            return original(publisher, msg)
        name = _nodes.topic_of(publisher, lambda: publisher.topic_name)
        handler = self._messages.find(Form.PUBLISH, name, _nodes.name_of(node))

        def publish(message: Any) -> Any:
            result = original(publisher, message)
            self._messages.heard(name, message)
            return result

        if handler is None:
            return publish(msg)
        return handler(publish, None, (msg,), {}, _nodes.where(node))

    def around(self, subscription: Any, callback: Any) -> Any:
        """Return what an executor calls instead of a subscription's callback."""
        node = _nodes.node_of(subscription)
        if node is None or subscription.raw:
            return callback
        known = getattr(subscription, _WRAPPED, None)
        if known is None or known[0] is not callback:
            known = (callback, self._around(subscription, callback, node))
            setattr(subscription, _WRAPPED, known)
        return known[1]

    def _around(self, subscription: Any, callback: Any, node: Any) -> Any:
        code, node_name = code_of(callback), _nodes.name_of(node)

        def received(message: Any, *more: Any) -> Any:
            name = _nodes.topic_of(subscription, lambda: subscription.topic_name)
            self._messages.heard(name, message)
            handler = self._messages.find(Form.RECEIVE, name, node_name)
            if handler is None:
                return callback(message, *more)
            return _nodes.where(node, code).deliver(
                handler, message, lambda delivered: callback(delivered, *more)
            )

        return as_called(callback, received)

    def wait(self, original: Any, msg_type: Any, node: Any, topic: Any, **kwargs: Any) -> Any:
        name = node.resolve_topic_name(topic)
        TYPES.note(Form.RECEIVE, name, msg_type)
        node_name = _nodes.name_of(node)
        handler = self._messages.find(Form.RECEIVE, name, node_name)
        limit = kwargs.pop("time_to_wait", -1)
        end = time.monotonic() + limit if limit >= 0 else None

        asked = False

        def waited() -> Any:
            nonlocal asked
            left = -1 if end is None else max(0.0, end - time.monotonic())
            if asked and left == 0.0:  # what is kept for late subscribers may come at once
                raise _NoMessage
            asked = True
            with _nodes.own():
                found, message = original(msg_type, node, topic, **kwargs, time_to_wait=left)
            if not found:
                raise _NoMessage
            self._messages.heard(name, message)
            return message

        try:
            if handler is None:
                return True, waited()
            is_kept = _is_kept(kwargs.get("qos_profile"))
            wait = _first(waited(), waited)  # the handler hears of no wait that brings nothing
            return True, _nodes.where(node).wait_for(handler, wait, lambda _: is_kept, time)
        except _NoMessage:
            return False, None


class _NoMessage(Exception):  # noqa: N818  (no error: there is no message)
    """Marks that no message has arrived in time."""


def _is_kept(qos_profile: Any) -> bool:
    """Return whether a received message may be one kept by the publisher for late subscribers."""
    durability = getattr(qos_profile, "durability", None)
    return getattr(durability, "name", None) == "TRANSIENT_LOCAL"


def _first(message: Any, otherwise: Callable[[], Any]) -> Callable[[], Any]:
    """Return a function that returns an existing message first, and then others."""
    there = [message]

    def wait() -> Any:
        return there.pop() if there else otherwise()

    return wait


def as_called(callback: Any, ours: Callable[..., Any]) -> Any:
    """Return ``ours`` in the form of the program's callback: as a coroutine function if that is one."""
    if not inspect.iscoroutinefunction(callback):
        return _named_like(callback, ours)

    async def called(*args: Any, **kwargs: Any) -> Any:
        result = ours(*args, **kwargs)
        return await result if inspect.isawaitable(result) else result

    return _named_like(callback, called)


def _named_like(callback: Any, ours: Any) -> Any:
    try:
        named: Any = functools.wraps(callback)(ours)
    except (AttributeError, TypeError):
        return ours
    with suppress(TypeError, ValueError):  # what is written in C may have none
        named.__signature__ = inspect.signature(callback)  # an executor asks for it at each tick
    return named


_NANO = 1e9


def qualities(qos: Any) -> dict[str, Any] | None:
    """Return the settings of a profile, or of a queue depth that stands for one; None for neither.

    A deadline of 0 is none. Policies that the middleware is to choose keep their name.
    """
    profile = _profile(qos)
    if profile is None:
        return None
    deadline = profile.deadline.nanoseconds / _NANO
    return {
        "depth": profile.depth,
        "reliability": profile.reliability.name.lower(),
        "durability": profile.durability.name.lower(),
        "deadline": deadline if deadline < 1e9 else 0.0,  # "infinite" is 292 years
    }


def changed(qos: Any, changes: dict[str, Any]) -> Any:
    """Return a profile with other values; the same object if there are no changes."""
    if not changes:
        return qos
    rclpy_qos: Any = import_module("rclpy.qos")
    profile = copy.copy(_profile(qos))
    for name, value in changes.items():
        match name:
            case "depth":
                profile.depth = max(0, int(value))
            case "reliability":
                profile.reliability = rclpy_qos.ReliabilityPolicy[str(value).upper()]
            case "durability":
                profile.durability = rclpy_qos.DurabilityPolicy[str(value).upper()]
            case "deadline":
                profile.deadline = import_module("rclpy.duration").Duration(seconds=float(value))
    return profile


def _profile(qos: Any) -> Any:
    kind: Any = import_module("rclpy.qos").QoSProfile
    if isinstance(qos, int) and not isinstance(qos, bool):
        return kind(depth=qos)
    return qos if isinstance(qos, kind) else None
