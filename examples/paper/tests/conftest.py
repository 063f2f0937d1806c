"""One simulated cell per test, drawn from the round's seed."""

from __future__ import annotations

from collections.abc import Iterator

import kinova
import pytest

from mutabot_cell import Cell, simulated_time


@pytest.fixture
def cell(mutabot_seed: int) -> Iterator[Cell]:
    """The published cell: robot at home, a red or blue box on the conveyor."""
    with Cell(mutabot_seed) as cell, simulated_time(cell):
        kinova.connect(cell)
        yield cell
