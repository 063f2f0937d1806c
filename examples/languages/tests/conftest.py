"""The cell of a test, and the program in each language."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pick
import pytest

from mutabot_cell import Box, Cell, Scene
from mutabot_cell.fixtures import *  # noqa: F403  (new_cell; fails a test whose condition broke in silence)
from mutabot_languages import load

ROOT = Path(__file__).parents[1]


@pytest.fixture
def cell_with(new_cell: Callable[..., Cell], mutabot_seed: int) -> Callable[..., Cell]:
    """Makes the test's cell with these boxes."""
    return lambda *boxes: new_cell(mutabot_seed, scene=Scene(parts=boxes))


@pytest.fixture(params=["pick.script", "pick.mod", "pick.src", "pick.py"])
def run(request: pytest.FixtureRequest) -> Callable[[Cell], None]:
    """Runs the program in one of the languages."""
    if request.param == "pick.py":
        return pick.run
    return lambda cell: load(ROOT / request.param).run(cell) and None


__all__ = ["Box"]
