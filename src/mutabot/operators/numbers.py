"""Numbers that operators change, alone or in a vector."""

from __future__ import annotations

from array import array
from typing import Any

from mutabot.model import Quantity
from mutabot.model.quantity import Value

from .operator import Unchanged


def is_number(value: Value) -> bool:
    """Whether a value is a plain number (numpy scalars included, truth values not)."""
    if isinstance(value, bool) or type(value).__name__ in ("bool_", "bool"):
        return False
    return isinstance(value, int | float) or (hasattr(value, "__float__") and not hasattr(value, "__len__"))


def map_numbers(value: Value, change: Any) -> Value | None:
    """``change`` applied to a number, or to each number of a vector; None where there is none.

    The container's type is kept: lists stay lists, tuples tuples, arrays arrays. An array of whole numbers
    becomes one of floating-point numbers.
    """
    if is_number(value):
        is_unsigned = getattr(getattr(value, "dtype", None), "kind", "") == "u"  # which has no other sign
        return change(int(value) if is_unsigned else value)
    if isinstance(value, list | tuple) and value and all(is_number(item) for item in value):
        return type(value)(change(item) for item in value)
    if isinstance(value, array) and len(value):
        return array(value.typecode if value.typecode in "fd" else "d", [change(item) for item in value])
    if hasattr(value, "dtype") and getattr(value, "ndim", 0) == 1:
        changed = value.copy() if value.dtype.kind == "f" else value.astype(float)
        for index in range(len(changed)):
            changed[index] = change(changed[index])
        return changed
    return None


def next_of(value: Value, quantity: Quantity, by: int = 1) -> Value:
    """The value that comes so many places after another one. Raises Unchanged if it is none of the values."""
    values = quantity.values or ()
    if value not in values:
        raise Unchanged("it is none of those that are known")
    return values[(values.index(value) + by) % len(values)]


def like(before: float, after: float) -> float:
    """A number in the type of the one in whose place it comes, where that loses nothing."""
    is_whole = isinstance(before, int) and not isinstance(before, bool) and float(after).is_integer()
    return int(after) if is_whole else after


def within(value: float, limits: tuple[float, float] | None) -> float:
    """A number, or the end of the limits that is nearest to it."""
    return value if limits is None else min(max(value, limits[0]), limits[1])


def middle_of(quantity: Quantity, share: float) -> tuple[float, float]:
    """The ends of the middle share of what a quantity may be. Raises Unchanged if nobody knows its range."""
    limits = quantity.range or quantity.clip
    if limits is None:
        raise Unchanged("the vocabulary gives no range")
    low, high = limits
    cut = (high - low) * (1.0 - share) / 2.0
    return low + cut, high - cut
