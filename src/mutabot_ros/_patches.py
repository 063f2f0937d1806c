"""Replaces functions of a client library, and restores them."""

from __future__ import annotations

import functools
from collections.abc import Callable
from types import CodeType
from typing import Any


class Patches:
    """The replaced functions; ``undo`` restores them, the last first."""

    def __init__(self) -> None:
        self._undo: list[Callable[[], None]] = []

    def put(self, owner: Any, name: str, ours: Callable[..., Any]) -> None:
        """Replace a function or method by ``ours(original, *args, **kwargs)``."""
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
        """Register another function that ``undo`` calls."""
        self._undo.append(undo)

    def undo(self) -> None:
        """Restore everything."""
        while self._undo:
            self._undo.pop()()


def code_of(callback: Any) -> CodeType | None:
    """Return the code of the program's function behind a callback; None if it is not Python."""
    while isinstance(callback, functools.partial):
        callback = callback.func
    callback = getattr(callback, "__wrapped__", callback)
    callback = getattr(callback, "__func__", callback)
    code = getattr(callback, "__code__", None)
    if code is None:  # an object that can be called
        code = getattr(getattr(type(callback), "__call__", None), "__code__", None)  # noqa: B004
    return code if isinstance(code, CodeType) else None
