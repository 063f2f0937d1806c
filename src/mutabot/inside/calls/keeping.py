"""Calls and replies that an operator remembers: copies, which the program cannot change afterwards."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any

from mutabot.model import Call, Reply

from .arguments import Arguments


def kept_call(call: Call) -> Call:
    """The same call, with copies of what the program gave: it may use an object again for the next call."""
    invocation = call.payload
    bound: Arguments | None = invocation.arguments
    values = bound.values if bound is not None else {}
    args, kwargs, values = copied((invocation.args, invocation.kwargs, values))
    arguments = Arguments(bound.signature, args, kwargs, values) if bound is not None else None
    return replace(call, payload=replace(invocation, args=args, kwargs=kwargs, arguments=arguments))


def held(call: Call) -> Call:
    """A call that is made later: what the vocabulary describes of its arguments is copied, all else is not.

    The program may use a pose again for the next call; an argument that is no data is the same object then.
    """
    invocation = call.payload
    bound: Arguments | None = invocation.arguments
    if bound is None or call.operation.named is not None:  # a message is data
        return kept_call(call)
    roots = {name for name in call.operation.described if name in bound.values}
    args, kwargs = bound.replaced({name: copied(bound.values[name]) for name in roots})
    arguments = Arguments.of(bound.signature, args, kwargs)
    return replace(call, payload=replace(invocation, args=args, kwargs=kwargs, arguments=arguments))


def kept_reply(reply: Reply) -> Reply:
    """The same reply, with a copy of what the robot answered."""
    return replace(reply, payload=copied(reply.payload))


def copied(value: Any) -> Any:
    """A copy of a value; the value itself if it cannot be copied."""
    try:
        return copy.deepcopy(value)
    except Exception:  # objects of the user's may refuse to be copied in any way
        return value
