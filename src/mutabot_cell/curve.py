"""A function defined by points."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise


class Curve:
    """A function that is linear between points, and beyond them.

    Args:
        inputs: of the points; each greater, or each smaller, than the one before.
        outputs: of the points.
    """

    def __init__(self, inputs: Sequence[float], outputs: Sequence[float]) -> None:
        self._starts = list(zip(inputs, outputs, strict=True))
        self._slopes = [(y1 - y0) / (x1 - x0) for (x0, y0), (x1, y1) in pairwise(self._starts)]
        self._rises = inputs[-1] > inputs[0]

    def __call__(self, value: float) -> float:
        """Return the output for this input."""
        index = self._index(value)
        start, output = self._starts[index]
        return output + (value - start) * self._slopes[index]

    def slope(self, value: float) -> float:
        """Return the function's slope at this input."""
        return self._slopes[self._index(value)]

    def _index(self, value: float) -> int:
        for index in range(1, len(self._slopes)):
            if (value < self._starts[index][0]) == self._rises:
                return index - 1
        return len(self._slopes) - 1
