"""Calls that go past an operation, because another method overrides it.

An overriding method is another callable than the one the vocabulary names. Where the vocabulary does not
include it, its calls are watched in one run of the original, so that the user can be told what to name.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

from mutabot.inside.targets.target import Handler
from mutabot.model.class_name import class_name

#: methods that are named in one sentence
_NAMED = 5

#: whether a watched method is under way here: only the outermost is the one that the program calls
_watching: ContextVar[bool] = ContextVar("mutabot_watching", default=False)


@dataclass(slots=True)
class Bypasses:
    """Calls of overriding methods that go past the operation that they override.

    Attributes:
        locate: finds the site of a frame; None for calls that are none of the program's.
        reached: how many calls of an operation (its target) have been seen so far in this test.
        is_under_way: whether an operation is under way.
        missed: calls that went past an operation, by target and overriding method.
        around: calls that reached it from within the overriding method, likewise.
    """

    locate: Callable[[FrameType | None], object | None]
    reached: Callable[[str], int]
    is_under_way: Callable[[], bool]
    missed: dict[str, dict[str, int]] = field(default_factory=dict)
    around: dict[str, dict[str, int]] = field(default_factory=dict)

    def handler(self, target: str, kind: type) -> Handler:
        """What stands around the overriding method of a class."""

        def handle(
            wrapped: Callable[..., Any], instance: Any, args: tuple[Any, ...], kwargs: dict[str, Any]
        ) -> Any:
            __tracebackhide__ = True
            if self.is_under_way() or _watching.get() or self.locate(sys._getframe(1)) is None:
                return wrapped(*args, **kwargs)
            if inspect.iscoroutinefunction(wrapped):
                return self._watch_async(target, kind, wrapped, args, kwargs)
            before, token = self.reached(target), _watching.set(True)
            try:
                return wrapped(*args, **kwargs)
            finally:
                _watching.reset(token)
                self._note(target, kind, before)

        return handle

    async def _watch_async(
        self,
        target: str,
        kind: type,
        wrapped: Callable[..., Any],
        args: tuple[Any, ...],
        kwargs: dict[str, Any],
    ) -> Any:
        __tracebackhide__ = True
        before, token = self.reached(target), _watching.set(True)
        try:
            return await wrapped(*args, **kwargs)
        finally:
            _watching.reset(token)
            self._note(target, kind, before)

    def _note(self, target: str, kind: type, before: int) -> None:
        kinds = self.missed if self.reached(target) == before else self.around
        counts = kinds.setdefault(target, {})
        name = f"{class_name(kind)}.{target.rpartition('.')[2]}"
        counts[name] = counts.get(name, 0) + 1

    def sentences(self, target: str) -> str:
        """What the user should know about an operation that other methods override; empty if nothing."""
        past, within = self.missed.get(target), self.around.get(target)
        found = []
        if past:
            found.append(_sentence(target, past, "so these calls went past it unseen"))
        if within:
            found.append(_sentence(target, within, "so only what these call of it is seen and mutated"))
        return ". ".join(found)


def _sentence(target: str, counts: Mapping[str, int], what: str) -> str:
    shown = [f"{name} ({_calls(count)})" for name, count in counts.items()]
    if len(shown) > _NAMED:
        shown[_NAMED:] = [f"{len(shown) - _NAMED} more"]
    listed = " and ".join(part for part in (", ".join(shown[:-1]), shown[-1]) if part)
    advice = "write overrides = true"
    if all("<locals>" not in name for name in counts):
        advice = f"name {'that' if len(counts) == 1 else 'those'} instead, or {advice}"
    return f"{target} is overridden by {listed}, {what}; {advice}"


def _calls(count: int) -> str:
    return "1 call" if count == 1 else f"{count} calls"
