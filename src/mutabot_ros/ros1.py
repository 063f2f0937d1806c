"""ROS 1: intercepts what a node does through rospy.

Topics are published through ``Publisher.publish`` and received in callbacks or by ``wait_for_message``; one
call of a service writes the request and reads the response. Fields that a program gives one by one are made a
message first, as rospy would. Actions and transforms have hooks of their own (``ros1_actions``, ``tf``).
"""

from __future__ import annotations

import functools
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

from mutabot.api.values import Finding, Form, Names, Operation

from . import _ros1_node as node
from ._patches import Patches, code_of
from ._ros1_types import Ros1Types

MODULE = "rospy"

#: what rospy itself publishes and subscribes to
OWN_TOPICS = frozenset({"/rosout", "/clock", "/statistics"})
_types = Ros1Types()


def hook(messages: Names) -> Callable[[], None]:
    """Intercept the messages of this process; return a function that removes the hooks."""
    patches = Patches()
    rospy: Any = sys.modules[MODULE]
    _PublishersAndSubscribers(messages).hook(patches, rospy)
    _ServiceProxies(messages).hook(patches, rospy)
    _ParameterServerValues(messages).hook(patches, rospy)
    _TimersAndRates(messages).hook(patches, rospy)
    for module in (rospy.client, rospy):
        patches.put(module, "init_node", functools.partial(_note, messages))
    node.clock.hook(patches, rospy)
    patches.then(_types.clear)
    return patches.undo


def check(operation: Operation) -> Iterator[Finding]:
    """Yield what in an operation does not fit the installed definition of its type, or the program's type."""
    return _types.check(operation)


def _note(messages: Names, original: Any, *args: Any, **kwargs: Any) -> Any:
    """Use the name of a node that starts as the name of its process."""
    original(*args, **kwargs)
    messages.note_node(node.name())


class _PublishersAndSubscribers:
    """Hooks of publishers and subscribers."""

    def __init__(self, messages: Names) -> None:
        self._messages = messages

    def hook(self, patches: Patches, rospy: Any) -> None:
        patches.put(rospy.Publisher, "__init__", self._advertise)
        patches.put(rospy.Publisher, "publish", self._publish)
        patches.put(rospy.Subscriber, "__init__", self._subscribe)
        patches.put(rospy.topics._SubscriberImpl, "_invoke_callback", self._receive)
        for module in (rospy.client, rospy):
            patches.put(module, "wait_for_message", self._wait)

    def _advertise(self, original: Any, publisher: Any, *args: Any, **kwargs: Any) -> None:
        given = node.bound(original, publisher, *args, **kwargs)
        handler = self._set_up(Form.ADVERTISE, given)
        if handler is None:
            original(publisher, *args, **kwargs)
            return

        def advertise(name: Any = ..., depth: Any = ..., latch: Any = ...) -> None:
            given.change(name=name, queue_size=depth, latch=latch)
            original(*given.args, **given.kwargs)

        settings = {"latch": False} | given.settings(name="name", depth="queue_size", latch="latch")
        handler(advertise, publisher, (), settings, node.where())

    def _subscribe(self, original: Any, subscriber: Any, *args: Any, **kwargs: Any) -> None:
        given = node.bound(original, subscriber, *args, **kwargs)
        handler = self._set_up(Form.SUBSCRIBE, given)
        if handler is None:
            original(subscriber, *args, **kwargs)
            return

        def subscribe(name: Any = ..., depth: Any = ...) -> None:
            given.change(name=name, queue_size=depth)
            original(*given.args, **given.kwargs)

        settings = given.settings(name="name", depth="queue_size")
        handler(subscribe, subscriber, (), settings, node.where())

    def _set_up(self, form: Form, given: node.CallArguments) -> Any:
        name = node.resolved(given.get("name"))
        if name is None or name in OWN_TOPICS:
            return None
        message = Form.PUBLISH if form is Form.ADVERTISE else Form.RECEIVE
        _types.note(message, name, given.get("data_class"))
        return self._messages.find(form, name, node.name())

    def _publish(self, original: Any, publisher: Any, *args: Any, **kwargs: Any) -> Any:
        name = publisher.resolved_name
        handler = None
        if name is not None and name not in OWN_TOPICS:
            handler = self._messages.find(Form.PUBLISH, name, node.name())
        if handler is None:
            return original(publisher, *args, **kwargs)
        made = node.message_of(publisher.data_class, args, kwargs)

        def publish(message: Any) -> Any:
            self._messages.heard(name, message)
            return original(publisher, message)

        return handler(publish, publisher, (made,), {}, node.where())

    def _receive(self, original: Any, topic: Any, message: Any, callback: Any, more: Any) -> None:
        self._messages.heard(topic.resolved_name, message)
        is_ours = isinstance(getattr(callback, "__self__", None), _waiter())
        handler = None
        if not is_ours and topic.resolved_name not in OWN_TOPICS:
            handler = self._messages.find(Form.RECEIVE, topic.resolved_name, node.name())
        if handler is None:
            original(topic, message, callback, more)
            return

        def call_back(received: Any) -> None:
            original(topic, node.with_sender(received, message), callback, more)

        node.where(code_of(callback)).deliver(handler, message, call_back)

    def _wait(self, original: Any, topic: str, topic_type: Any, timeout: Any = None) -> Any:
        name = node.resolved(topic) or topic
        _types.note(Form.RECEIVE, name, topic_type)
        handler = self._messages.find(Form.RECEIVE, name, node.name())
        if handler is None:
            return original(topic, topic_type, timeout)
        seconds = timeout.to_sec() if hasattr(timeout, "to_sec") else timeout
        end = None if seconds is None else time.monotonic() + seconds

        def wait() -> Any:
            return original(topic, topic_type, None if end is None else max(0.0, end - time.monotonic()))

        return node.where().wait_for(handler, wait, _is_latched, time)


class _ServiceProxies:
    """Hooks of service proxies."""

    def __init__(self, messages: Names) -> None:
        self._messages = messages

    def hook(self, patches: Patches, rospy: Any) -> None:
        patches.put(rospy.ServiceProxy, "__init__", self._make)
        patches.put(rospy.ServiceProxy, "call", self._call)

    def _make(self, original: Any, proxy: Any, *args: Any, **kwargs: Any) -> None:
        given = node.bound(original, proxy, *args, **kwargs)
        name = node.resolved(given.get("name"))
        handler = None
        if name is not None:
            _types.note(Form.CALL, name, given.get("service_class"))
            handler = self._messages.find(Form.CLIENT, name, node.name())
        if handler is None:
            original(proxy, *args, **kwargs)
            return

        def make(name: Any = ...) -> None:
            given.change(name=name)
            original(*given.args, **given.kwargs)

        handler(make, proxy, (), given.settings(name="name"), node.where())

    def _call(self, original: Any, proxy: Any, *args: Any, **kwargs: Any) -> Any:
        handler = self._messages.find(Form.CALL, proxy.resolved_name, node.name())
        if handler is None:
            return original(proxy, *args, **kwargs)
        made = node.message_of(proxy.request_class, args, kwargs)

        def call(request: Any) -> Any:
            return original(proxy, request)

        async def lost() -> Any:
            rospy: Any = sys.modules[MODULE]
            name = proxy.resolved_name
            raise rospy.ServiceException(
                f"transport error completing service call: {name} closed the connection"
            )

        return handler(call, proxy, (made,), {}, node.where(lost=lost))


class _ParameterServerValues:
    """Hooks of values on the parameter server."""

    def __init__(self, messages: Names) -> None:
        self._messages = messages

    def hook(self, patches: Patches, rospy: Any) -> None:
        for reader in ("get_param", "get_param_cached"):
            for module in (rospy.client, rospy):
                if hasattr(module, reader):
                    patches.put(module, reader, self._get)

    def _get(self, original: Any, param_name: str, *args: Any, **kwargs: Any) -> Any:
        name = node.resolved(param_name) or param_name
        handler = self._messages.find(Form.PARAMETER, name, node.name())
        if handler is None:
            return original(param_name, *args, **kwargs)

        def get(default: Any = ...) -> Any:
            return original(param_name) if default is ... else original(param_name, default)

        defaults = {"default": args[0]} if args else kwargs
        return handler(get, None, (), defaults, node.where())


class _TimersAndRates:
    """Hooks of timers and rates. A timer is named after its callback, a rate after its node."""

    def __init__(self, messages: Names) -> None:
        self._messages = messages

    def hook(self, patches: Patches, rospy: Any) -> None:
        patches.put(rospy.Timer, "__init__", self._make_timer)
        patches.put(rospy.Rate, "__init__", self._make_rate)
        patches.put(rospy.Rate, "sleep", self._sleep)
        self._run = rospy.timer.Timer.run.__code__

    def _make_timer(self, original: Any, timer: Any, *args: Any, **kwargs: Any) -> None:
        given = node.bound(original, timer, *args, **kwargs)
        callback, duration = given.get("callback"), given.get("period")
        code = code_of(callback)
        if code is None or not hasattr(duration, "to_sec"):
            original(timer, *args, **kwargs)
            return
        name = code.co_qualname
        given.change(callback=functools.partial(self._tick, name, callback))
        handler = self._messages.find(Form.TIMER, name, node.name())
        if handler is None:
            original(*given.args, **given.kwargs)
            return
        seconds = duration.to_sec()

        def make(period: Any = ...) -> None:
            if period != seconds:
                given.change(period=sys.modules[MODULE].Duration.from_sec(period))
            original(*given.args, **given.kwargs)

        handler(make, timer, (), {"period": seconds}, node.where())

    def _tick(self, name: str, callback: Any, event: Any) -> Any:
        handler = self._messages.find(Form.TICK, name, node.name())
        if handler is None:
            return callback(event)
        return node.where(code_of(callback)).deliver(handler, event, callback)

    def _make_rate(self, original: Any, rate: Any, hz: Any, *args: Any, **kwargs: Any) -> None:
        handler = None if self._is_timers() else self._messages.find(Form.RATE, node.name(), node.name())
        if handler is None:
            original(rate, hz, *args, **kwargs)
            return

        def make(period: Any = ...) -> None:
            original(rate, hz if period == 1.0 / hz else 1.0 / period, *args, **kwargs)

        handler(make, rate, (), {"period": 1.0 / hz}, node.where())

    def _sleep(self, original: Any, rate: Any) -> Any:
        handler = None if self._is_timers() else self._messages.find(Form.SLEEP, node.name(), node.name())
        if handler is None:
            return original(rate)
        return handler(lambda: original(rate), rate, (), {}, node.where())

    def _is_timers(self) -> bool:
        """Return whether it is the rate inside a timer."""
        return sys._getframe(3).f_code is self._run


def _is_latched(message: Any) -> bool:
    """Return whether the publisher keeps its last message for late subscribers."""
    header = getattr(message, "_connection_header", None) or {}
    return str(header.get("latching")) == "1"


def _waiter() -> type:
    waiter: type = sys.modules["rospy.client"]._WFM
    return waiter
