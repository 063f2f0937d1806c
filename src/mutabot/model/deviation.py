"""Deviation: how far a mutant is from the original, in units of the original's own spread.

The one number by which survivors are ranked, and the test is chosen that reports describe. The spread of a
quantity is what it differs by in runs of the original with different seeds; where that is less than the
tolerance of its unit, the tolerance takes its place. Hence one unit means: no more than the original does by
itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from math import tau
from types import MappingProxyType

from mutabot.model.units import apart

#: differences that count as none, by unit
TOLERANCES: Mapping[str, float] = MappingProxyType(
    {"m": 0.001, "mm": 1.0, "deg": 0.5, "rad": 0.01, "s": 0.1, "m/s": 0.01}
)
#: a full turn, by unit
TURNS: Mapping[str, float] = MappingProxyType({"deg": 360.0, "rad": tau})


def deviation_of(difference: float, spread: float, tolerance: float) -> float:
    """Return a difference in units of the original's spread, or of the tolerance where that is larger."""
    return difference / max(spread, tolerance)


def difference_of(first: float, second: float, unit: str | None) -> float:
    """Return the distance of two numbers; of two angles, modulo a full turn."""
    turn = TURNS.get(unit or "")
    return abs(first - second) if turn is None else apart(first, second, turn)


def spread_of(values: Sequence[float], unit: str | None = None) -> float:
    """Return the greatest distance between any two numbers; of fewer than two, zero."""
    pairs = combinations(values, 2)
    return max((difference_of(first, second, unit) for first, second in pairs), default=0.0)
