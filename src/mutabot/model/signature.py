"""Signatures as a vocabulary writes them, for callables that tell none: ``(body, joints, mode=0, …)``.

``…`` (or ``...``) stands for what is not said: as the last item for any further arguments, as a default for
one that is not known.
"""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator
from functools import lru_cache
from inspect import Parameter, Signature
from typing import Any

#: how a callable is taken that tells nothing
ANYTHING = Signature(
    [Parameter("args", Parameter.VAR_POSITIONAL), Parameter("kwargs", Parameter.VAR_KEYWORD)]
)
_FORM = 'write it as in Python, such as "(body, joints, speed=0.5, …)"'


@lru_cache(maxsize=256)
def parse_signature(text: str) -> Signature:
    """The signature in such a text, without ``self``. A default that is not known is ``...``.

    Raises ValueError, saying what is wrong.
    """
    arguments = _arguments(text)
    positional = [*arguments.posonlyargs, *arguments.args]
    defaults = [*[None] * (len(positional) - len(arguments.defaults)), *arguments.defaults]
    parameters = []
    for index, (name, default) in enumerate(zip(positional, defaults, strict=True)):
        is_only = index < len(arguments.posonlyargs)
        kind = Parameter.POSITIONAL_ONLY if is_only else Parameter.POSITIONAL_OR_KEYWORD
        if index or name.arg not in ("self", "cls"):
            parameters.append(_parameter(name, kind, default))
    if arguments.vararg is not None:
        parameters.append(Parameter(arguments.vararg.arg, Parameter.VAR_POSITIONAL))
    for name, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True):
        parameters.append(_parameter(name, Parameter.KEYWORD_ONLY, default))
    if arguments.kwarg is not None:
        parameters.append(Parameter(arguments.kwarg.arg, Parameter.VAR_KEYWORD))
    return Signature(parameters)


def takes_anything(signature: Signature) -> bool:
    """Whether arguments of any number and name fit, so that the signature does not tell what they mean."""
    kinds = {parameter.kind for parameter in signature.parameters.values()}
    return {Parameter.VAR_POSITIONAL, Parameter.VAR_KEYWORD} <= kinds


def _arguments(text: str) -> ast.arguments:
    text = text.strip().replace("…", "...")
    if not text.startswith("("):
        raise ValueError(f"{text!r} does not begin with a bracket; {_FORM}")
    try:
        tree = ast.parse(f"def _{_with_rest(text)}: pass")
    except (SyntaxError, ValueError) as error:
        reason = getattr(error, "msg", str(error))
        raise ValueError(f"{text!r} is no signature ({reason}); {_FORM}") from None
    body = tree.body[0]
    if len(tree.body) != 1 or not isinstance(body, ast.FunctionDef) or not isinstance(body.body[0], ast.Pass):
        raise ValueError(f"{text!r} is no signature; {_FORM}")
    names = [name.arg for name in _names(body.args)]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{text!r} names {name!r} twice")
    return body.args


def _with_rest(text: str) -> str:
    """The text with an ellipsis at its end written as Python would."""
    inside, bracket, after = text.rpartition(")")
    start, dots, end = inside.rpartition("...")
    before = start.rstrip()
    if not bracket or not dots or end.strip(" ,") or not before.endswith(("(", ",")):
        return text
    return f"{before} {'' if '*' in before else '*args, '}{'' if '**' in before else '**kwargs'}){after}"


def _names(arguments: ast.arguments) -> Iterator[ast.arg]:
    yield from (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)
    yield from (one for one in (arguments.vararg, arguments.kwarg) if one is not None)


def _parameter(name: ast.arg, kind: Any, default: ast.expr | None) -> Parameter:
    if default is None:
        return Parameter(name.arg, kind)
    try:
        return Parameter(name.arg, kind, default=ast.literal_eval(default))
    except ValueError:
        text = ast.unparse(default)
        raise ValueError(
            f"the default of {name.arg!r}, {text}, is no plain value; write … for one that is not known"
        ) from None


def signature_of(wrapped: Any) -> Signature | None:
    """What a callable tells about its arguments; None if it tells nothing."""
    try:
        return inspect.signature(wrapped)
    except (TypeError, ValueError):
        return None
