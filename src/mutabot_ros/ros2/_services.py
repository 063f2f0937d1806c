"""Intercepts services of ROS 2: their clients, with and without waiting."""

from __future__ import annotations

import threading
from collections.abc import Awaitable, Callable
from importlib import import_module
from typing import Any

from mutabot.api.values import Form, Names
from mutabot_ros._patches import Patches

from . import _nodes
from ._steps import FutureAnswer, Never, future_of, inner_of
from ._types import TYPES

_SLICE = 0.1


def hook(patches: Patches, messages: Names) -> None:
    """Hook service clients."""
    services = _Services(messages)
    client: Any = import_module("rclpy.client").Client
    patches.put(import_module("rclpy.node").Node, "create_client", services.make)
    patches.put(client, "call", services.call)
    patches.put(client, "call_async", services.call_async)
    patches.put(client, "remove_pending_request", _remove)


def _remove(original: Any, client: Any, future: Any) -> Any:
    return original(client, inner_of(future))


class _Services:
    def __init__(self, messages: Names) -> None:
        self._messages = messages

    def make(self, original: Any, node: Any, srv_type: Any, srv_name: Any, **kwargs: Any) -> Any:
        def made(name: Any) -> Any:
            client = original(node, srv_type, name, **kwargs)
            _nodes.claim(client, node)
            return client

        try:
            resolved = node.resolve_service_name(srv_name)
        except Exception:  # rclpy says what is wrong with it, in its own way
            return made(srv_name)
        TYPES.note(Form.CALL, resolved, srv_type)
        handler = self._messages.find(Form.CLIENT, resolved, _nodes.name_of(node))
        if handler is None:
            return made(srv_name)
        return handler(made, None, (), {"name": srv_name}, _nodes.where(node))

    def call(self, original: Any, client: Any, request: Any, timeout_sec: float | None = None) -> Any:
        handler = self._handler(client, request)
        if handler is None:
            return original(client, request, timeout_sec)

        def call(request: Any) -> Any:
            return original(client, request, timeout_sec)

        node = _nodes.node_of(client)
        return handler(call, None, (request,), {}, _nodes.where(node, lost=_waits(client, timeout_sec)))

    def call_async(self, original: Any, client: Any, request: Any) -> Any:
        handler = self._handler(client, request)
        if handler is None:
            return original(client, request)

        async def call(request: Any) -> Any:
            return await FutureAnswer(original(client, request))

        where = _nodes.where(_nodes.node_of(client), is_async=True, lost=never)
        return future_of(handler(call, None, (request,), {}, where))

    def _handler(self, client: Any, request: Any) -> Any:
        node = _nodes.node_of(client)
        if node is None or not isinstance(request, client.srv_type.Request):
            return None
        name = _nodes.topic_of(client, lambda: node.resolve_service_name(client.srv_name))
        return self._messages.find(Form.CALL, name, _nodes.name_of(node))


async def never() -> Any:
    """Wait for ever, in place of an answer that never arrives."""
    await Never()


def _waits(client: Any, timeout_sec: float | None) -> Callable[[], Awaitable[Any]]:
    async def lost() -> Any:
        over = threading.Event()
        if timeout_sec is not None:
            over.wait(timeout_sec)
            raise TimeoutError
        while client.context.ok():
            over.wait(_SLICE)
        raise TimeoutError

    return lost
