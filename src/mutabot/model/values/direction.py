"""Which speeds and ratios have a direction, so that a negative value means the other way."""

from __future__ import annotations

from .path import Path
from .quantity import Kind, Quantity

#: kinds that may be a motion with a direction, or only its magnitude
EITHER = frozenset({Kind.SPEED, Kind.RATIO})
_COMPONENTS = frozenset({"x", "y", "z"})


def has_direction(quantity: Quantity) -> bool | None:
    """Whether negative values of a speed or ratio make sense; None if the vocabulary does not say.

    What the vocabulary allows decides first. Otherwise, a component along an axis, the speed of a joint and
    a vector have a direction. A number of its own may be the speed of a motor or a speed limit.
    """
    if quantity.values is not None:
        return any(value < 0 for value in quantity.values)
    limits = quantity.range or quantity.clip
    if limits is not None:
        return limits[0] < 0
    return True if quantity.axis is not None or _is_part_of_vector(quantity.path) else None


def _is_part_of_vector(path: Path) -> bool:
    """Whether a path leads to a component of a vector, such as ``linear.x``, or to a slice of one."""
    if not path.steps:
        return path.root in _COMPONENTS
    last = path.steps[-1]
    return last.bounds is not None or last.attribute in _COMPONENTS or last.item in _COMPONENTS
