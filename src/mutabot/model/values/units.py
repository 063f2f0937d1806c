"""Units a vocabulary may use, and their conversion to SI."""

from __future__ import annotations

import math
from enum import StrEnum


class Dimension(StrEnum):
    """What a unit measures."""

    LENGTH = "length"
    ANGLE = "angle"
    TIME = "time"
    RATIO = "ratio"


#: unit -> (dimension, factor to SI: metre, radian, second, fraction)
UNITS: dict[str, tuple[Dimension, float]] = {
    "m": (Dimension.LENGTH, 1.0),
    "cm": (Dimension.LENGTH, 0.01),
    "mm": (Dimension.LENGTH, 0.001),
    "rad": (Dimension.ANGLE, 1.0),
    "deg": (Dimension.ANGLE, math.pi / 180.0),
    "s": (Dimension.TIME, 1.0),
    "ms": (Dimension.TIME, 0.001),
    "fraction": (Dimension.RATIO, 1.0),
    "percent": (Dimension.RATIO, 0.01),
}


def dimension_of(unit: str) -> Dimension:
    """The dimension a unit measures. Raises KeyError for an unknown unit."""
    return UNITS[unit][0]


def convert(value: float, unit: str, to: str) -> float:
    """``value`` given in ``unit``, expressed in ``to``.

    Raises ValueError when the two units measure different things. A conversion between equal units
    returns the value untouched, so that nothing is rounded without need.
    """
    if unit == to:
        return value
    dimension, factor = UNITS[unit]
    other_dimension, other_factor = UNITS[to]
    if dimension is not other_dimension:
        raise ValueError(f"cannot convert {unit} ({dimension}) to {to} ({other_dimension})")
    return value * factor / other_factor
