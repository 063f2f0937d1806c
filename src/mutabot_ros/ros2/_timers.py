"""Intercepts timers and rates of nodes. A timer is named after its callback, a rate after its node."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from mutabot.api.values import Form, Names
from mutabot_ros._patches import Patches, code_of

from . import _nodes
from ._topics import as_called


def hook(patches: Patches, messages: Names) -> None:
    """Hook timers and rates."""
    times = _NodeTimers(messages)
    node: Any = import_module("rclpy.node").Node
    patches.put(node, "create_timer", times.make_timer)
    patches.put(node, "create_rate", times.make_rate)
    patches.put(import_module("rclpy.timer").Rate, "sleep", times.sleep)


class _NodeTimers:
    def __init__(self, messages: Names) -> None:
        self._messages = messages

    def make_timer(
        self, original: Any, node: Any, timer_period_sec: Any, callback: Any, *args: Any, **kwargs: Any
    ) -> Any:
        code = code_of(callback)
        if _nodes.is_own() or code is None:  # a rate has a timer whose callback comes later
            return original(node, timer_period_sec, callback, *args, **kwargs)
        name = code.co_qualname
        ours = self._around(node, name, callback)

        def made(period: Any) -> Any:
            return original(node, period, ours, *args, **kwargs)

        handler = self._messages.find(Form.TIMER, name, _nodes.name_of(node))
        if handler is None:
            return made(timer_period_sec)
        return handler(made, None, (), {"period": timer_period_sec}, _nodes.where(node))

    def _around(self, node: Any, name: str, callback: Any) -> Any:
        code = code_of(callback)

        def ticked(*args: Any, **kwargs: Any) -> Any:
            handler = self._messages.find(Form.TICK, name, _nodes.name_of(node))
            if handler is None:
                return callback(*args, **kwargs)
            return _nodes.where(node, code).deliver(handler, None, lambda _: callback(*args, **kwargs))

        return as_called(callback, ticked)

    def make_rate(self, original: Any, node: Any, frequency: Any, *args: Any, **kwargs: Any) -> Any:
        def made(period: Any) -> Any:
            hertz = frequency if period == given else 1.0 / period
            rate = original(node, hertz, *args, **kwargs)
            _nodes.claim(rate, node)
            return rate

        name = _nodes.name_of(node)
        handler = self._messages.find(Form.RATE, name, name) if name is not None else None
        given = 1.0 / frequency if frequency > 0 else None
        if handler is None or given is None:
            return made(given)
        return handler(made, None, (), {"period": given}, _nodes.where(node))

    def sleep(self, original: Any, rate: Any) -> Any:
        node = _nodes.node_of(rate)
        name = _nodes.name_of(node)
        handler = self._messages.find(Form.SLEEP, name, name) if name is not None else None
        if handler is None:
            return original(rate)
        return handler(lambda: original(rate), None, (), {}, _nodes.where(node))
