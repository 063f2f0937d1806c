"""One simulated cell per test, drawn from the round's seed, watched from the first tick to the last."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from monitors import watch_box, watch_gripper, watch_tilt

from mutabot_cell import Box, Cell, Scene
from mutabot_cell.fixtures import *  # noqa: F403  (new_cell; fails a test whose condition broke in silence)


@pytest.fixture
def cell_with(new_cell: Callable[..., Cell], mutabot_seed: int) -> Callable[..., Cell]:
    """Makes the test's cell, with at most one box; one that slips may lean, one that gets lost may fall."""

    def make(*boxes: Box, slips: bool = False, gets_lost: bool = False) -> Cell:
        cell = new_cell(mutabot_seed, scene=Scene(parts=boxes))
        watch_gripper(cell)
        if boxes and not gets_lost:
            watch_box(cell)
        if boxes and not gets_lost and not slips:
            watch_tilt(cell)
        return cell

    return make
