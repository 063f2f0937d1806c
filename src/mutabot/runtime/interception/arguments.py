"""The arguments of one call, by name, and how to give others in their place.

A changed argument goes to the callable in the way the program gave it: by position or by keyword. What the
program left out stays left out, so that a native callable sees only what it was given.

Calls and replies that an operator remembers: copies, which the program cannot change afterwards.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from inspect import Parameter, Signature
from typing import Any

from mutabot.model import Call, Reply
from mutabot.model.signature import ANYTHING, parse_signature, signature_of

_POSITIONAL = (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD)


def signature_for(declared: str | None, wrapped: Callable[..., Any]) -> Signature:
    """The signature by which to read calls: the vocabulary's, else the callable's own, else any."""
    if declared is not None:
        return parse_signature(declared)
    return signature_of(wrapped) or ANYTHING


@dataclass(slots=True)
class Arguments:
    """The arguments of one call.

    Attributes:
        signature: by which they are read.
        args, kwargs: as the program gave them.
        values: by parameter, with defaults that are known.
    """

    signature: Signature
    args: tuple[Any, ...]
    kwargs: dict[str, Any]
    values: dict[str, Any]

    @classmethod
    def of(cls, signature: Signature, args: tuple[Any, ...], kwargs: dict[str, Any]) -> Arguments | None:
        """The arguments of a call; None if they do not fit the signature."""
        try:
            bound = signature.bind(*args, **kwargs)
        except TypeError:
            return None
        bound.apply_defaults()
        known = {name: value for name, value in bound.arguments.items() if value is not ...}
        return cls(signature, args, kwargs, known)

    def get(self, name: str) -> Any:
        """The argument of this name; None if the call does not give it. It may be one of ``**kwargs``."""
        if name in self.signature.parameters:
            return self.values.get(name)
        return self._more().get(name)

    def replaced(self, changes: Mapping[str, Any]) -> tuple[tuple[Any, ...], dict[str, Any]]:
        """Positional and keyword arguments with other values for these names."""
        args, kwargs = list(self.args), dict(self.kwargs)
        for name, value in changes.items():
            self._replace(args, kwargs, name, value)
        return tuple(args), kwargs

    def _replace(self, args: list[Any], kwargs: dict[str, Any], name: str, value: Any) -> None:
        parameter = self.signature.parameters.get(name)
        kind = parameter.kind if parameter is not None else Parameter.KEYWORD_ONLY
        positional = [one.name for one in self.signature.parameters.values() if one.kind in _POSITIONAL]
        if kind is Parameter.VAR_POSITIONAL:
            args[len(positional) :] = value
        elif kind is Parameter.VAR_KEYWORD:
            for key in self.values.get(name, ()):
                kwargs.pop(key, None)
            kwargs.update(value)
        elif kind in _POSITIONAL and positional.index(name) < len(args):
            args[positional.index(name)] = value
        elif kind is Parameter.POSITIONAL_ONLY:  # a default: what comes before it must be given as well
            before = positional[len(args) : positional.index(name)]
            args.extend(self.values.get(one) for one in before)
            args.append(value)
        else:
            kwargs[name] = value

    def _more(self) -> Mapping[str, Any]:
        for parameter in self.signature.parameters.values():
            if parameter.kind is Parameter.VAR_KEYWORD:
                more: Mapping[str, Any] = self.values.get(parameter.name, {})
                return more
        return {}


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
