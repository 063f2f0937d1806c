"""One simulated station per test, drawn from the round's seed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from station import Station, build

from mutabot_cell import Cell
from mutabot_cell.fixtures import *  # noqa: F403  (new_cell; fails a test whose condition broke in silence)


@pytest.fixture
def station_with(new_cell: Callable[..., Cell], mutabot_seed: int) -> Callable[..., Station]:
    """Makes the test's station; arguments as for `station.build`."""

    def make(**options: Any) -> Station:
        return build(new_cell, mutabot_seed, **options)

    return make
