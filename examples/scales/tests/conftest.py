"""One cell per test, drawn from the round's seed."""

from __future__ import annotations

import link
import pytest
from cell import Cell


@pytest.fixture(params=["red", "blue"])
def colour(request: pytest.FixtureRequest) -> str:
    """Both colours, one after the other."""
    return str(request.param)


@pytest.fixture
def cell(mutabot_seed: int, colour: str) -> Cell:
    """A cell with a box of this colour on the feeder."""
    cell = Cell(mutabot_seed, colour)
    link.connect(cell)
    return cell
