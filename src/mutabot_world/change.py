"""Changes of numbers, also of a number at the end of a path of attributes and items."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

_STEP = re.compile(r"\.?([A-Za-z_]\w*)|\[(-?\d+)\]|\[[\"']([^\"']+)[\"']\]")

#: takes a disturbance away
Undo = Callable[[], object]


class NotInWorldError(LookupError):
    """The world has nothing of the name that a parameter refers to."""


@dataclass(frozen=True, slots=True)
class NumberChange:
    """A change of a number: an offset, a scale factor or a new value.

    Attributes:
        kind: ``offset``, ``scale`` or ``set``.
        amount: with its sign: what is added; what part of it is added; or what it becomes.
        effects: whether numbers became others, as far as any were changed.
    """

    kind: str
    amount: float
    effects: set[bool] = field(default_factory=set, compare=False)

    def __call__(self, value: Any) -> Any:
        """Return the changed number, or array."""
        if self.kind == "scale":
            changed = value * (1.0 + self.amount)
        else:
            changed = value + self.amount if self.kind == "offset" else value * 0 + self.amount
        self.effects.add(not _is_same(value, changed))
        return changed

    @property
    def factor(self) -> float:
        """The factor by which values are multiplied. Raises ValueError if the change is not a scale."""
        if self.kind != "scale":
            raise ValueError(f'only a change = "scale" has a factor, and this is {self.kind!r}')
        return 1.0 + self.amount


def change_at(world: Any, path: str, change: NumberChange) -> tuple[Any, Any, Undo]:
    """Change the number at a path of attributes and items.

    Args:
        world: where the path begins.
        path: ``simulation.model.opt.gravity[2]``.
        change: what becomes of it.

    Returns it before and after, and what takes the change away. Raises NotInWorldError.
    """
    *way, last = _steps(path)
    owner = world
    for name, item in way:
        owner = _get(owner, name, item, path)
    before = _get(owner, *last, path)
    before = before.copy() if hasattr(before, "copy") else before
    try:
        _set(owner, *last, change(before))
    except (AttributeError, LookupError, TypeError, ValueError) as error:
        raise NotInWorldError(f"{path} cannot be changed: {error}") from error
    after = _get(owner, *last, path)  # an array of whole numbers or a setter may have made another of it
    if _is_same(before, after):
        raise NotInWorldError(f"{path} is {before} with the change as well")
    return before, after, lambda: _set(owner, *last, before)


def _is_same(before: Any, after: Any) -> bool:
    same = before == after
    return bool(same.all() if hasattr(same, "all") else same)


def _steps(path: str) -> list[tuple[str, Any]]:
    found, position = list[tuple[str, Any]](), 0
    while position < len(path):
        step = _STEP.match(path, position)
        if step is None:
            raise ValueError(f"path {path!r} makes no sense from {path[position:]!r} on")
        name, number, key = step.groups()
        found.append((name or "", int(number) if number is not None else key))
        position = step.end()
    return found


def _get(owner: Any, name: str, item: Any, path: str) -> Any:
    try:
        return getattr(owner, name) if name else owner[item]
    except (AttributeError, LookupError, TypeError) as error:
        what = f"{type(owner).__name__} has no {name or f'[{item!r}]'} (path {path!r})"
        raise NotInWorldError(what) from error


def _set(owner: Any, name: str, item: Any, value: Any) -> None:
    if name:
        setattr(owner, name, value)
    else:
        owner[item] = value
