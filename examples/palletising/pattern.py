"""Where 27 boxes stand on a pallet: three layers of nine, each a mirror image of the one below it.

     first and third layer            second layer
    ┌────────┬─────┬─────┬─────┐     ┌─────┬─────┬─────┬────────┐
    │   1    │     │     │     │     │     │     │     │   1    │
    ├────────┤  4  │  6  │  8  │     │  8  │  6  │  4  ├────────┤    y
    │   2    ├─────┼─────┼─────┤     ├─────┼─────┼─────┤   2    │    ▲
    ├────────┤     │     │     │     │     │     │     ├────────┤    │
    │   3    │  5  │  7  │  9  │     │  9  │  7  │  5  │   3    │    └──► x
    └────────┴─────┴─────┴─────┘     └─────┴─────┴─────┴────────┘

Boxes of one layer bridge the seams of the layer below.
Lengths in m, from the middle of the pallet's deck.
"""

from __future__ import annotations

from dataclasses import dataclass

LENGTH, WIDTH, HEIGHT = 0.12, 0.08, 0.08
"""Of a box."""
GAP = 0.004
"""Between boxes: what they may lie beside the cup, on both sides, and the arm's own error."""
LAYERS = 3


@dataclass(frozen=True)
class Slot:
    """The place of one box.

    Attributes:
        x, y, z: of the middle of its bottom face.
        across: whether its long side lies along y.
    """

    x: float
    y: float
    z: float
    across: bool


def slots() -> list[Slot]:
    """All places, in the order in which they are filled."""
    return [slot for number in range(LAYERS) for slot in layer(number)]


def layer(number: int) -> list[Slot]:
    """The places of one layer; 0 is the lowest."""
    side, z = (-1 if number % 2 else 1), number * HEIGHT
    long, short = LENGTH + GAP, WIDTH + GAP
    whole = long + 3 * short
    column_of_three = side * (long - whole) / 2
    along = [Slot(column_of_three, y, z, across=False) for y in (short, 0.0, -short)]
    columns_of_two = [side * (long + (n + 0.5) * short - whole / 2) for n in range(3)]
    across = [Slot(x, y, z, across=True) for x in columns_of_two for y in (long / 2, -long / 2)]
    return along + across
