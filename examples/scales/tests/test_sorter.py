"""The program puts the box where its colour belongs."""

from __future__ import annotations

import sorter
from cell import Cell
from scales import Loads, loads

EXPECTED = {"red": Loads(left=True, right=False), "blue": Loads(left=False, right=True)}


def test_the_box_ends_on_the_scale_of_its_colour(cell: Cell, colour: str) -> None:
    sorter.run()
    assert loads() == EXPECTED[colour]
