"""How far readings of the original are apart by themselves, and what that shows about further runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeGuard

from mutabot.frozen import frozen

CONFIDENCE = 0.95


@frozen
class Band:
    """What a reading of the original stays within.

    Attributes:
        middle: of all runs.
        tolerance: to each side of the middle, the least that a check may ask for.
        spread: the greatest distance of two runs.
        runs: how many there are.
    """

    middle: float
    tolerance: float
    spread: float
    runs: int


def band_of(values: Sequence[float], floor: float) -> Band:
    """The range of the runs, widened by itself on both sides; ``floor`` is the least tolerance.

    No distribution is assumed. Of a normal one with 20 runs, fewer than 1 in 100 000 lie outside.
    """
    low, high = min(values), max(values)
    return Band((low + high) / 2, max(floor, 1.5 * (high - low)), high - low, len(values))


def unseen(count: int) -> float:
    """The share of runs in which something may happen that did not in ``count``, with ``CONFIDENCE``."""
    return 1 - (1 - CONFIDENCE) ** (1 / count) if count else 1.0


def readable(band: Band, nearest: float, stated: float = 0.0) -> tuple[float, float]:
    """Value and tolerance as a person would write them.

    The tolerance is the one that the tests state already, if it lies between the band's and ``nearest``, the
    least distance of a survivor from the middle; else the largest of 1, 2, 5, 10 … that is at most half of
    ``nearest``, never under the band's. The value has no more digits than that needs.
    """
    tolerance = stated if band.tolerance <= stated < nearest else _round_up(band.tolerance)
    while tolerance != stated and _next(tolerance) <= nearest / 2:
        tolerance = _next(tolerance)
    digits = -math.floor(math.log10(tolerance) + 1e-9)
    value = round(band.middle, digits)
    while abs(value - band.middle) + band.tolerance > tolerance * (1 + 1e-9) and digits < 12:
        digits += 1
        value = round(band.middle, digits)
        if abs(value - band.middle) <= 0.01 * tolerance:
            break
    return value + 0.0, tolerance


def _round_up(size: float) -> float:
    step = 10.0 ** math.floor(math.log10(size))
    factor = next(one for one in (1, 2, 5, 10) if one * step >= size * (1 - 1e-9))
    return float(f"{factor * step:.1g}")


def _next(size: float) -> float:
    return _round_up(size * 1.5)


def digits_of(value: float) -> int:
    """How many digits a person must read."""
    return len(f"{value!r}".partition("e")[0].replace(".", "").strip("-0")) if value else 1


def decimal(value: float) -> str:
    """A number as a text of a program."""
    text = repr(float(value))
    return "0.0" if text == "-0.0" else text


def is_number(value: Any) -> TypeGuard[float]:
    """Whether a value is one that can be near another."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
