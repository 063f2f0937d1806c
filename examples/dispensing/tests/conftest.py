"""One simulated station per test, drawn from the round's seed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from sealing import NOMINAL_X, NOMINAL_Y, NOMINAL_Z, SEAM
from station import Housing, Station, build

from mutabot_cell import Cell
from mutabot_cell.fixtures import *  # noqa: F403  (new_cell; fails a test whose condition broke in silence)


@pytest.fixture
def station_with(new_cell: Callable[..., Cell], mutabot_seed: int) -> Callable[..., Station]:
    """Makes the test's station; arguments as for `station.build`."""

    def make(**options: Any) -> Station:
        nominal = Housing(NOMINAL_X, NOMINAL_Y, NOMINAL_Z, 0.0)
        return build(new_cell, mutabot_seed, nominal, list(SEAM), **options)

    return make
