"""Readings that come in steps, as times of a simulation do."""

from __future__ import annotations

from collections.abc import Iterable

#: decimals of a step at most: finer ones cannot be told from no steps at all
_DECIMALS = 4


def step_of(values: Iterable[float]) -> float | None:
    """The power of ten of which all these are multiples, below 1; None if there is none, or all are whole."""
    values = list(values)
    for decimals in range(_DECIMALS + 1):
        if all(abs(value - round(value, decimals)) <= 1e-9 * max(1.0, abs(value)) for value in values):
            return 10.0**-decimals if decimals else None
    return None
