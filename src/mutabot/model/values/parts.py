"""Orientations whose numbers are attributes, as a message's quaternion has ``x``, ``y``, ``z`` and ``w``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .path import Path, Step


def numbers_of(value: Any, names: Sequence[str]) -> Any:
    """The numbers of an object that has them as attributes of these names; anything else as it is."""
    if value is None or hasattr(value, "__len__") or not all(hasattr(value, name) for name in names):
        return value
    return [getattr(value, name) for name in names]


def with_numbers(value: Any, names: Sequence[str], numbers: Any) -> Any:
    """A copy of such an object with other numbers; in place of anything else, the numbers themselves.

    Raises PathError if it cannot be copied and changed.
    """
    if numbers_of(value, names) is value:
        return numbers
    for name, number in zip(names, numbers, strict=True):
        value = Path(None, (Step(attribute=name),)).put(value, number)
    return value
