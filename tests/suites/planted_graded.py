"""Graded faults as plain functions, written without Mutabot; the judge puts this beside a copy.

Edits reach it by ``__import__("_planted_graded")``. Sizes are in the unit of the value.
"""

from __future__ import annotations

import inspect
import os
import random
from collections.abc import Callable
from functools import partial
from typing import Any

Change = Callable[[float], float]
__all__ = ["partial"]

_RANDOM = random.Random(int(os.environ.get("JUDGE_NOISE", "1")))
_LAST: dict[str, float] = {}


def numbers(index: int | None, low: float, high: float, whole: bool, change: Change, value: Any) -> Any:
    """A number changed, or one of a vector; as it is where that would leave the range."""
    if index is not None:
        if not hasattr(value, "__len__") or index >= len(value):
            return value
        changed = value.copy() if hasattr(value, "copy") else list(value)
        changed[index] = numbers(None, low, high, whole, change, value[index])
        return type(value)(changed) if isinstance(value, tuple) else changed
    if value is None or isinstance(value, bool | str) or not hasattr(value, "__float__"):
        return value
    after = change(float(value))
    after = round(after) if whole else after
    return after if low <= after <= high else value


def noisy(size: float, value: float) -> float:
    """With noise of this deviation."""
    return value + _RANDOM.gauss(0.0, size)


def in_steps(size: float, value: float) -> float:
    """The nearest multiple."""
    return round(value / size) * size


def shorter(size: float, value: float) -> float:
    """A wait that ends earlier, unless it would end before it begins."""
    return value - size if value - size >= -1e-9 else value


def with_deadband(size: float, name: str, relative: bool, value: float) -> float:
    """The last value where the new one is near it; nothing where a relative move is short."""
    origin = 0.0 if relative else _LAST.get(name)
    after = value if origin is None or abs(value - origin) >= size else origin
    _LAST[name] = after
    return after


def with_default(function: Callable[..., Any], name: str, change: Change) -> Callable[..., Any]:
    """A function that is told another value of a parameter than its default."""
    default = inspect.signature(function).parameters[name].default

    def told(*args: Any, **kwargs: Any) -> Any:
        return function(*args, **{name: change(default), **kwargs})

    return told


def before(wait: Callable[[float], Any], seconds: float, function: Callable[..., Any]) -> Callable[..., Any]:
    """A function that is called later."""

    def later(*args: Any, **kwargs: Any) -> Any:
        wait(seconds)
        return function(*args, **kwargs)

    return later


def after(wait: Callable[[float], Any], seconds: float, function: Callable[..., Any]) -> Callable[..., Any]:
    """A function whose answer comes later."""

    def later(*args: Any, **kwargs: Any) -> Any:
        answer = function(*args, **kwargs)
        wait(seconds)
        return answer

    return later
