"""The arguments of one call, by name, and how to give others in their place.

A changed argument goes to the callable in the way the program gave it: by position or by keyword. What the
program left out stays left out, so that a native callable sees only what it was given.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from inspect import Parameter, Signature
from typing import Any

from mutabot.model.values.signature import ANYTHING, parse_signature, signature_of

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
