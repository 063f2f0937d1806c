"""Actions of ROS 1: intercepts what a node does through actionlib's clients.

A simple client's goal is sent, its feedback and result received in callbacks or read afterwards. Clients
without the word simple are not seen.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from mutabot.api.values import Form, Names

from . import _ros1_node as node
from ._patches import Patches, code_of

MODULE = "actionlib"

#: how a goal ends that is not reached, by the status of actionlib_msgs/GoalStatus
_ENDINGS = {2: "CANCELED", 4: "ABORTED", 5: "REJECTED", 8: "CANCELED"}


def hook(messages: Names) -> Callable[[], None]:
    """Intercept the goals of this process; return a function that removes the hooks."""
    patches = Patches()
    actionlib: Any = sys.modules[MODULE]
    simple, client = _Simple(messages), actionlib.SimpleActionClient
    patches.put(client, "__init__", simple.make)
    patches.put(client, "send_goal", simple.send)
    patches.put(client, "get_result", simple.result)
    patches.put(client, "_handle_transition", simple.note_end)
    patches.put(client, "cancel_goal", simple.cancel)
    patches.put(client, "cancel_all_goals", simple.cancel)
    return patches.undo


class _Simple:
    """Hooks of simple action clients."""

    def __init__(self, messages: Names) -> None:
        self._messages = messages

    def make(self, original: Any, client: Any, *args: Any, **kwargs: Any) -> None:
        """Record a client that is created."""
        given = node.bound(original, client, *args, **kwargs)
        name = node.resolved(given.get("ns"))
        handler = self._messages.find(Form.CLIENT, name, node.name()) if name is not None else None
        if handler is None:
            original(client, *args, **kwargs)
            return

        def make(name: Any = ...) -> None:
            given.change(ns=name)
            original(*given.args, **given.kwargs)

        handler(make, client, (), {"name": given.get("ns")}, node.where())

    def send(self, original: Any, client: Any, goal: Any, *args: Any, **kwargs: Any) -> Any:
        """Send a goal, whose callbacks are intercepted."""
        name = _name(client)
        given = node.bound(original, client, goal, *args, **kwargs)
        feedback, done = given.get("feedback_cb"), given.get("done_cb")
        if feedback is not None:
            given.change(feedback_cb=self._with_feedback(name, feedback))
        if done is not None:
            given.change(done_cb=self._with_result(name, done))
        handler = self._messages.find(Form.GOAL, name, node.name())
        if handler is None:
            return original(*given.args, **given.kwargs)

        def send(goal: Any) -> Any:
            given.change(goal=goal)
            return original(*given.args, **given.kwargs)

        async def lost() -> Any:
            client.stop_tracking_goal()

        async def cancel(result: Any) -> None:
            client.cancel_goal()

        return handler(send, client, (goal,), {}, node.where(lost=lost, cancel=cancel))

    def result(self, original: Any, client: Any) -> Any:
        """Return the result for which the program asks."""
        handler = self._messages.find(Form.RESULT, _name(client), node.name())
        if handler is None:
            return original(client)
        return handler(lambda: original(client), client, (), {}, node.where(lost=_nothing))

    def note_end(self, original: Any, client: Any, handle: Any) -> Any:
        """Record that the state of a goal has changed."""
        ended: Any = sys.modules["actionlib.action_client"].CommState.DONE
        if handle == client.gh and handle.get_comm_state() == ended:
            name, status = _name(client), handle.get_goal_status()
            self._messages.heard(name, handle.get_result())
            if status in _ENDINGS:
                self._messages.heard(name, _ENDINGS[status])
        return original(client, handle)

    def cancel(self, original: Any, client: Any) -> Any:
        """Cancel the program's goal, or all goals."""
        handler = self._messages.find(Form.CANCEL, _name(client), node.name())
        if handler is None:
            return original(client)
        return handler(lambda: original(client), client, (), {}, node.where())

    def _with_feedback(self, name: str, callback: Callable[[Any], Any]) -> Callable[[Any], Any]:
        def receive(feedback: Any) -> Any:
            handler = self._messages.find(Form.FEEDBACK, name, node.name())
            if handler is None:
                return callback(feedback)
            return node.where(code_of(callback)).deliver(handler, feedback, callback)

        return receive

    def _with_result(self, name: str, callback: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
        def receive(status: Any, result: Any) -> Any:
            handler = self._messages.find(Form.RESULT, name, node.name())
            if handler is not None:
                where = node.where(code_of(callback), lost=_nothing)
                result = handler(lambda: result, None, (), {}, where)
            return callback(status, result)

        return receive


async def _nothing() -> Any:
    return None


def _name(client: Any) -> str:
    return node.resolved(client.action_client.ns) or client.action_client.ns
