"""Parse signatures in a vocabulary, for callables without one: ``(body, joints, mode=0, …)``.

``…`` (or ``...``) stands for what is not said: as the last item for any further arguments, as a default for
one that is not known.
"""

from __future__ import annotations

import ast
import inspect
from functools import lru_cache
from inspect import Parameter, Signature
from typing import Any

#: the signature of a callable that has none
ANYTHING = Signature(
    [Parameter("args", Parameter.VAR_POSITIONAL), Parameter("kwargs", Parameter.VAR_KEYWORD)]
)
_FORM = 'write it as in Python, such as "(body, joints, speed=0.5, …)"'


@lru_cache(maxsize=256)
def parse_signature(text: str) -> Signature:
    """Parse such a signature, without ``self``. A default that is not known is ``...``.

    Raises ValueError, saying what is wrong.
    """
    arguments = _arguments(text)
    positional = [*arguments.posonlyargs, *arguments.args]
    kinds: list[Any] = [Parameter.POSITIONAL_ONLY for _ in arguments.posonlyargs]
    kinds += [Parameter.POSITIONAL_OR_KEYWORD for _ in arguments.args]
    defaults = [*[None] * (len(positional) - len(arguments.defaults)), *arguments.defaults]
    found = list(map(_parameter, positional, kinds, defaults))
    if found and found[0].name in ("self", "cls"):
        del found[0]
    if arguments.vararg is not None:
        found.append(Parameter(arguments.vararg.arg, Parameter.VAR_POSITIONAL))
    for name, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True):
        found.append(_parameter(name, Parameter.KEYWORD_ONLY, default))
    if arguments.kwarg is not None:
        found.append(Parameter(arguments.kwarg.arg, Parameter.VAR_KEYWORD))
    try:
        return Signature(found)
    except ValueError as error:  # a name twice
        raise ValueError(f"{text!r} is not a signature ({error}); {_FORM}") from None


def takes_anything(signature: Signature) -> bool:
    """Return whether a signature accepts any arguments, so that it does not name them."""
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
        raise ValueError(f"{text!r} is not a signature ({reason}); {_FORM}") from None
    body = tree.body[0]
    if len(tree.body) != 1 or not isinstance(body, ast.FunctionDef) or not isinstance(body.body[0], ast.Pass):
        raise ValueError(f"{text!r} is not a signature; {_FORM}")
    return body.args


def _with_rest(text: str) -> str:
    """Return the text with a final ellipsis written as ``*args, **kwargs``."""
    inside, bracket, after = text.rpartition(")")
    start, dots, end = inside.rpartition("...")
    before = start.rstrip()
    if not bracket or not dots or end.strip(" ,") or not before.endswith(("(", ",")):
        return text
    return f"{before} {'' if '*' in before else '*args, '}{'' if '**' in before else '**kwargs'}){after}"


def _parameter(name: ast.arg, kind: Any, default: ast.expr | None) -> Parameter:
    if default is None:
        return Parameter(name.arg, kind)
    try:
        return Parameter(name.arg, kind, default=ast.literal_eval(default))
    except ValueError:
        text = ast.unparse(default)
        raise ValueError(
            f"the default of {name.arg!r}, {text}, is not a plain value; write … for one that is not known"
        ) from None


def signature_of(wrapped: Any) -> Signature | None:
    """Return the signature of a callable; None if it has none."""
    try:
        return inspect.signature(wrapped)
    except (TypeError, ValueError):
        return None
