"""The script puts the box where its colour belongs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
import station
from cell import Cell

SCRIPT = Path(__file__).parents[1] / "sort_box.py"
#: a scale with more than this on it is loaded, g
LOADED = 100.0


@pytest.mark.parametrize(("colour", "side", "other"), [("red", "left", "right"), ("blue", "right", "left")])
def test_the_box_ends_on_the_scale_of_its_colour(
    mutabot_seed: int, colour: str, side: str, other: str
) -> None:
    cell = Cell(mutabot_seed, colour)
    with station.listening(cell) as port:
        subprocess.run([sys.executable, str(SCRIPT), str(port)], check=True, timeout=60)
    assert float(cell.reading(f"weight/{side}")) > LOADED
    assert float(cell.reading(f"weight/{other}")) <= LOADED
