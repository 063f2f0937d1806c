"""Intercepts actions of ROS 2: goals, feedback, results, and cancelling."""

from __future__ import annotations

import copy
import sys
from typing import Any

import wrapt

from mutabot.api.values import Form, Names
from mutabot_ros._patches import Patches, code_of

from . import _nodes
from ._services import never
from ._steps import FutureAnswer, future_of
from ._topics import as_called
from ._types import TYPES

_MODULE = "rclpy.action.client"
#: what the goal's service is called; actions are renamed by it
_SERVICE = "/_action/send_goal"
#: words for the states in which a goal has ended badly, as ``action_msgs/GoalStatus`` numbers them
_ENDINGS = {5: "CANCELED", 6: "ABORTED"}


def hook(patches: Patches, messages: Names) -> None:
    """Hook action clients as soon as the program imports them."""
    actions = _Actions(messages)

    def imported(module: Any) -> None:
        if actions.is_over:
            return
        client = module.ActionClient
        patches.put(client, "__init__", actions.make)
        patches.put(client, "send_goal_async", actions.send)
        patches.put(client, "_get_result_async", actions.result)
        patches.put(client, "_cancel_goal_async", actions.cancel)

    if _MODULE in sys.modules:
        imported(sys.modules[_MODULE])
    else:
        wrapt.register_post_import_hook(imported, _MODULE)
    patches.then(actions.end)


class _Actions:
    def __init__(self, messages: Names) -> None:
        self._messages = messages
        self.is_over = False

    def end(self) -> None:
        """Remove all hooks."""
        self.is_over = True

    def make(
        self, original: Any, client: Any, node: Any, action_type: Any, action_name: Any, **kwargs: Any
    ) -> None:
        def made(name: Any) -> None:
            original(client, node, action_type, name, **kwargs)
            _nodes.claim(client, node)

        try:
            resolved = node.resolve_service_name(action_name + _SERVICE).removesuffix(_SERVICE)
        except Exception:  # rclpy says what is wrong with it, in its own way
            return made(action_name)
        TYPES.note(Form.GOAL, resolved, action_type)
        handler = self._messages.find(Form.CLIENT, resolved, _nodes.name_of(node))
        if handler is None:
            return made(action_name)
        handler(made, None, (), {"name": action_name}, _nodes.where(node))
        return None

    def send(
        self, original: Any, client: Any, goal: Any, feedback_callback: Any = None, goal_uuid: Any = None
    ) -> Any:
        handler = self._handler(Form.GOAL, client)
        if feedback_callback is not None:
            feedback_callback = self._around(client, feedback_callback)
        if handler is None or not isinstance(goal, client._action_type.Goal):
            return original(client, goal, feedback_callback, goal_uuid)

        async def send(goal: Any) -> Any:
            return await FutureAnswer(original(client, goal, feedback_callback, goal_uuid))

        async def cancel(handle: Any) -> None:
            if handle.accepted:
                await FutureAnswer(type(client)._cancel_goal_async.__wrapped__(client, handle))

        where = _nodes.where(_nodes.node_of(client), is_async=True, lost=never, cancel=cancel)
        return future_of(handler(send, None, (goal,), {}, where))

    def _around(self, client: Any, callback: Any) -> Any:
        code = code_of(callback)

        def received(message: Any) -> Any:
            handler = self._handler(Form.FEEDBACK, client)
            if handler is None:
                return callback(message)

            def called(feedback: Any) -> Any:
                return callback(_with(message, "feedback", feedback))

            return _nodes.where(_nodes.node_of(client), code).deliver(handler, message.feedback, called)

        return as_called(callback, received)

    def result(self, original: Any, client: Any, goal_handle: Any) -> Any:
        handler = self._handler(Form.RESULT, client)
        if handler is None and self._messages.on_heard is None:
            return original(client, goal_handle)
        name = self._name(client)
        answers: list[Any] = []

        async def result() -> Any:
            answer = await FutureAnswer(original(client, goal_handle))
            self._messages.heard(name, answer.result)
            if answer.status in _ENDINGS:
                self._messages.heard(name, _ENDINGS[answer.status])
            answers.append(answer)
            return answer.result

        async def whole(read: Any) -> Any:
            found = await read
            if not answers:  # a mutant that asks for nothing answers itself
                return found
            return _with(answers[-1], "result", found)

        if handler is None:
            return future_of(whole(result()))
        where = _nodes.where(_nodes.node_of(client), is_async=True, lost=never)
        return future_of(whole(handler(result, None, (), {}, where)))

    def cancel(self, original: Any, client: Any, goal_handle: Any) -> Any:
        handler = self._handler(Form.CANCEL, client)
        if handler is None:
            return original(client, goal_handle)

        async def cancel() -> Any:
            return await FutureAnswer(original(client, goal_handle))

        where = _nodes.where(_nodes.node_of(client), is_async=True, lost=never)
        return future_of(handler(cancel, None, (), {}, where))

    def _handler(self, form: Form, client: Any) -> Any:
        return self._messages.find(form, self._name(client), _nodes.name_of(_nodes.node_of(client)))

    def _name(self, client: Any) -> str:
        def ask() -> str:
            name: str = client._node.resolve_service_name(client._action_name + _SERVICE)
            return name.removesuffix(_SERVICE)

        return _nodes.topic_of(client, ask)


def _with(message: Any, field: str, value: Any) -> Any:
    """Return the message if its field has that value, else a copy in which it has."""
    if getattr(message, field) is value:
        return message
    copied = copy.copy(message)
    setattr(copied, field, value)
    return copied
