"""One simulated cell per test, drawn from the round's seed, watched from the first tick to the last."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest
from layout import on_belt, on_pallet, scene
from monitors import watch_belt, watch_boxes, watch_cup, watch_stack

from mutabot_cell import Box, Cell, gen3, suction_cup
from mutabot_cell.fixtures import *  # noqa: F403  (new_cell; fails a test whose condition broke in silence)


@pytest.fixture
def cell_with(new_cell: Callable[..., Cell], mutabot_seed: int) -> Callable[..., Cell]:
    """Makes the test's cell: boxes on the belt, so many on the pallet, and other things.

    Boxes in `belt` are watched unless they are named in `troubled`: those may lean or fall.
    """

    def make(
        belt: Sequence[Box] | None = None,
        *,
        placed: int = 0,
        others: Sequence[Box] = (),
        pallet: bool = True,
        troubled: Sequence[str] = (),
    ) -> Cell:
        coming = on_belt(1) if belt is None else belt
        stack = on_pallet(placed)
        cell = new_cell(
            mutabot_seed,
            robot=gen3().with_tool(suction_cup(0.030)),
            scene=scene(*coming, *stack, *others, pallet=pallet),
        )
        watch_belt(cell)
        watch_cup(cell)
        watch_stack(cell, [box.name for box in (*stack, *others)])
        watch_boxes(cell, [box.name for box in coming if box.name not in troubled])
        return cell

    return make
