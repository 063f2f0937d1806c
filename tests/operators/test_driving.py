"""When a mutant counts as having changed something."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from mutabot.model.quantity import same


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (0.1 + 0.2, 0.3, True),
        (-1.27e-14, 0.0, True),
        (0.5, 0.5001, False),
        (1, 1.0, True),
        (math.nan, math.nan, True),
        (True, False, False),
        ("red", "blue", False),
        ([0.1, 0.2], [0.1, 0.2], True),
        (np.array([1.0, 2.0]), np.array([1.0, 2.0]), True),
        (np.array([1.0, 2.0]), np.array([1.0, -2.0]), False),
        (None, 0.0, False),
    ],
)
def test_values_are_the_same_up_to_rounding(first: Any, second: Any, expected: bool) -> None:
    assert same(first, second) is expected
