"""Functions of a client library with ours in their place, and the way back."""

from __future__ import annotations

import functools
from collections.abc import Callable
from types import CodeType
from typing import Any


class Patches:
    """What was put in place; ``undo`` takes it away again, last one first."""

    def __init__(self) -> None:
        self._undo: list[Callable[[], None]] = []

    def put(self, owner: Any, name: str, ours: Callable[..., Any]) -> None:
        """Let ``ours(original, *args, **kwargs)`` be called in the place of a function or method."""
        original = getattr(owner, name)

        @functools.wraps(original)
        def patched(*args: Any, **kwargs: Any) -> Any:
            return ours(original, *args, **kwargs)

        is_own = name in vars(owner)
        setattr(owner, name, patched)
        self._undo.append(
            functools.partial(setattr, owner, name, original)
            if is_own
            else functools.partial(delattr, owner, name)
        )

    def then(self, undo: Callable[[], None]) -> None:
        """Have something else undone too."""
        self._undo.append(undo)

    def undo(self) -> None:
        """Take all of it away."""
        while self._undo:
            self._undo.pop()()


def code_of(callback: Any) -> CodeType | None:
    """The function of the program's that a callback leads to; None for one that is no Python."""
    while isinstance(callback, functools.partial):
        callback = callback.func
    callback = getattr(callback, "__wrapped__", callback)
    callback = getattr(callback, "__func__", callback)
    code = getattr(callback, "__code__", None)
    if code is None:  # an object that can be called
        code = getattr(getattr(type(callback), "__call__", None), "__code__", None)  # noqa: B004
    return code if isinstance(code, CodeType) else None
