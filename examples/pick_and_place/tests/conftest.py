"""One simulated cell per test, drawn from the round's seed, watched from the first tick to the last."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from monitors import watch_fingers

from mutabot.cells import Box, Cell, Scene
from mutabot.cells.fixtures import *  # noqa: F403  (new_cell; fails a test whose condition broke in silence)


@pytest.fixture
def cell_with(new_cell: Callable[..., Cell], mutabot_seed: int) -> Callable[..., Cell]:
    """Makes the test's cell, with these boxes."""

    def make(*boxes: Box) -> Cell:
        cell = new_cell(mutabot_seed, scene=Scene(boxes=boxes))
        watch_fingers(cell)
        return cell

    return make
