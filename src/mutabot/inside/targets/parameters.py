"""Whether the arguments that the vocabulary describes exist, and whether calls will tell them apart."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from functools import cached_property
from typing import Any

from mutabot.model import Operation
from mutabot.model.values.signature import (
    described_in,
    parse_signature,
    signature_of,
    spell_signature,
    takes_anything,
)

from .target import Finding

_ONLY_READ = "only its reading is seen; describe the method that its setter calls"
#: how deep decorators are looked into for the function that they wrap
_DEPTH = 5


def look_at(operation: Operation, original: Any) -> Iterator[Finding]:
    """What is to be said about the described arguments of an operation.

    Args:
        operation: what the vocabulary says.
        original: the callable that its target names, as it is kept in its class or module.
    """
    callable = getattr(original, "__func__", original)
    described = operation.described
    if isinstance(original, property | cached_property):
        for key in described.values():
            yield Finding(key, f"{operation.target} is a property: {_ONLY_READ}")
        return
    signature = signature_of(callable)
    if operation.signature is not None:
        signature = parse_signature(operation.signature)
    elif signature is None or takes_anything(signature):
        unnamed = [root for root in described if signature is None or root not in signature.parameters]
        if unnamed:
            yield Finding("signature", _advice(operation, callable, signature is None), is_remark=True)
        return
    if any(one.kind is inspect.Parameter.VAR_KEYWORD for one in signature.parameters.values()):
        return
    known = tuple(name for name in signature.parameters if name not in ("self", "cls"))
    for root, key in described.items():
        if root not in signature.parameters:
            yield Finding(key, f"{operation.target} has no argument {root!r}", root, known)


def _advice(operation: Operation, callable: Any, is_native: bool) -> str:
    name = operation.name.rpartition(".")[2]
    if is_native:
        why = f"{operation.target} is native and does not tell its arguments"
        found = described_in(getattr(callable, "__doc__", None), name)
    else:
        why = f"{operation.target} is wrapped in (*args, **kwargs), which does not tell its arguments"
        found = _wrapped_in(callable, name, _DEPTH)
    proposal = spell_signature(found) if found is not None else f"({', '.join(operation.described)}, …)"
    order = "" if found is not None else ", with all names in their order"
    return (
        f"{why}: only those that a call gives by keyword can be told apart; "
        f'write signature = "{proposal}"{order}'
    )


def _wrapped_in(function: Any, name: str, depth: int) -> inspect.Signature | None:
    """The signature of the function of this name that a decorator keeps in its closure."""
    for cell in getattr(function, "__closure__", None) or ():
        try:
            content = cell.cell_contents
        except ValueError:  # not filled yet
            continue
        if not inspect.isfunction(content):
            continue
        found = signature_of(content) if content.__name__ == name else None
        if found is None and depth:
            found = _wrapped_in(content, name, depth - 1)
        if found is not None and not takes_anything(found):
            return found
    return None
