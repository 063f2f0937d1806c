"""The bands in which the original's readings stay, and the numbers with which to write a check of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

CONFIDENCE = 0.95
#: digits of a value, down to its tolerance, above which it is no more than what the original happened to read
DIGITS = 3
#: where the tests state no tolerance, it is at most this share of the value, or this many times the band's
_SHARE, _ROOM = 0.1, 10


@dataclass(frozen=True, slots=True)
class Band:
    """The range in which a reading of the original stays.

    Attributes:
        middle: of all runs.
        tolerance: to each side of the middle, the least that a check may ask for.
        spread: the greatest distance of two runs.
    """

    middle: float
    tolerance: float
    spread: float


def band_of(values: Sequence[float], floor: float) -> Band:
    """Return the range of the runs' values, widened on both sides; ``floor`` is the least tolerance.

    No distribution is assumed. Of a normal one with 20 runs, fewer than 1 in 100 000 lie outside.
    """
    low, high = min(values), max(values)
    return Band((low + high) / 2, max(floor, 1.5 * (high - low)), high - low)


def unseen(count: int) -> float:
    """Return the frequency that an event unseen in ``count`` runs may still have, with ``CONFIDENCE``."""
    return 1 - (1 - CONFIDENCE) ** (1 / count) if count else 1.0


def readable(band: Band, nearest: float, stated: float = 0.0) -> tuple[float, float]:
    """Round a value and its tolerance as a person would.

    The tolerance is the one that the tests state already, if it lies between the band's and ``nearest``, the
    least distance of a survivor from the middle; else the largest of 1, 2, 5, 10 … that is at most half of
    ``nearest``, and a tenth of the value or ten times the band's; never under the band's. The value has no
    more digits than that needs, but a short one stays.
    """
    most = nearest / 2
    if band.middle:
        most = min(most, max(_SHARE * abs(band.middle), _ROOM * band.tolerance))
    tolerance = stated if band.tolerance <= stated < nearest else _round_up(band.tolerance)
    while tolerance != stated and _round_up(tolerance * 1.5) <= most:
        tolerance = _round_up(tolerance * 1.5)
    digits = -math.floor(math.log10(tolerance) + 1e-9)
    value = band.middle if digits_of(band.middle) < DIGITS else round(band.middle, digits)
    while abs(value - band.middle) + band.tolerance > tolerance * (1 + 1e-9) and digits < 12:
        digits += 1
        value = round(band.middle, digits)
        if abs(value - band.middle) <= 0.01 * tolerance:
            break
    return value + 0.0, tolerance


def _round_up(size: float) -> float:
    step = 10.0 ** math.floor(math.log10(size))
    factor = next(step_factor for step_factor in (1, 2, 5, 10) if step_factor * step >= size * (1 - 1e-9))
    return float(f"{factor * step:.1g}")


def digits_of(value: float) -> int:
    """Return the number of digits of a value."""
    return len(f"{value!r}".partition("e")[0].replace(".", "").strip("-0")) if value else 1


def precision_of(value: float, tolerance: float) -> int:
    """Return how many digits of a value matter for a check with this tolerance; zero counts as 0.1."""
    return math.floor(math.log10(abs(value) or 0.1)) - math.floor(math.log10(tolerance) + 1e-9) + 1
