"""Methods that override an operation's: which classes have one, now and later."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

_MAKING = "__init_subclass__"


def overriding(owner: type, name: str) -> Iterator[type]:
    """The classes below ``owner`` that define ``name`` themselves."""
    waiting: list[type] = list(reversed(type.__subclasses__(owner)))
    seen: set[int] = set()
    while waiting:
        kind = waiting.pop()
        if id(kind) in seen:
            continue
        seen.add(id(kind))
        waiting.extend(reversed(type.__subclasses__(kind)))
        if vars(kind).get(name) is not None:
            yield kind


def watch_subclasses(owner: type, notice: Callable[[type], None]) -> Callable[[], None]:
    """Be told of every class that is made below ``owner`` from now on; returns how to end that.

    A class whose ``__init_subclass__`` does not call that of its bases is not told.
    """
    own = vars(owner).get(_MAKING)
    base: Any = owner

    def init_subclass(cls: Any, /, **options: Any) -> None:
        if own is not None:
            own.__get__(None, cls)(**options)
        else:
            super(base, cls).__init_subclass__(**options)
        notice(cls)

    setattr(owner, _MAKING, classmethod(init_subclass))

    def end() -> None:
        if own is not None:
            setattr(owner, _MAKING, own)
        else:
            delattr(owner, _MAKING)

    return end
