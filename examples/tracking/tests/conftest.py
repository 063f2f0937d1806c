"""One simulated cell per test, drawn from the round's seed, watched from the first tick to the last."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from monitors import watch_box, watch_gripper

from mutabot_cell import Belt, Box, Cell, Scene
from mutabot_cell.fixtures import *  # noqa: F403  (new_cell; fails a test whose condition broke in silence)
from mutabot_cell.scene import CONVEYOR, TARGET_TABLE


@pytest.fixture
def cell_with(new_cell: Callable[..., Cell], mutabot_seed: int) -> Callable[..., Cell]:
    """Makes the test's cell with boxes upstream on a belt whose speed wanders by `jitter` of itself.

    Boxes named in `troubled` may slip, lean, fall or get past.
    """

    def make(*boxes: Box, jitter: float = 0.03, troubled: tuple[str, ...] = ()) -> Cell:
        belt = replace(CONVEYOR, belt=Belt(jitter=jitter))
        cell = new_cell(mutabot_seed, scene=Scene(fixtures=(belt, TARGET_TABLE), parts=boxes))
        watch_gripper(cell)
        for box in boxes:
            if box.name not in troubled:
                watch_box(cell, box.name)
        return cell

    return make
