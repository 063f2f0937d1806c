"""What stands around the robot: a feeder with a pin, a clamped housing, a tray with its cover, a screwdriver.

The equipment is simulated here, as its makers describe it; the program uses what it commands and reads.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random

from screwdriver import HANDLE, Screwdriver

from mutabot_cell import Box, Cell, Fixture, Scene, gen3

TABLE_TOP = 1.0
"""Of the table above the floor, m; the robot's base stands 0.1 m lower."""
EDGE, LENGTH, PIN_MASS = 0.02, 0.08, 0.05
"""Edge, length, m, and mass, kg, of a pin."""
GAP, DEPTH = 0.0008, 0.025
"""Clearance of the housing's hole, both sides together, and its depth, m."""
COVER, COVER_MASS = (0.16, 0.06, 0.008), 0.2
"""Edges, m, and mass, kg, of a cover: aluminium."""
RIM, RIM_WIDTH = 0.085, 0.024
"""Height of the housing's two walls, on which the cover rests 5 mm above the pin, and their width, m."""
SCREWS = ((-0.068, -0.018), (0.068, 0.018), (0.068, -0.018), (-0.068, 0.018))
"""Where the threads are from the hole, m."""
HOLE, FEEDER, TRAY, RACK, CHUTE = (0.50, 0.10), (0.50, -0.10), (0.50, 0.33), (0.56, -0.22), (0.36, -0.30)
"""Where hole, pin, cover and screwdriver should be, and where rejects are dropped; world frame, m."""
OFF, BAR, SUPPORT, RACK_GAP = 0.001, 0.04, 0.03, 0.0024
"""The fixture puts a housing down no further off than this; thickness of the sides of its hole; height of the
tray; clearance of the rack around the screwdriver, m."""
CLAMPING_TIME = 0.3
"""Of the clamp, s."""


class Clamp:
    """A pneumatic clamp that holds the housing in its fixture.

    Attributes:
        works: whether it has air.
    """

    def __init__(self, cell: Cell, works: bool) -> None:
        self._cell, self.works, self._since = cell, works, float("inf")

    def close(self) -> None:
        """Begin to close it."""
        self._since = self._cell.time

    def open(self) -> None:
        """Open it."""
        self._since = float("inf")

    def is_closed(self) -> bool:
        """Whether its switch reports that it holds the housing."""
        return self.works and self._cell.time - self._since >= CLAMPING_TIME


class Inputs:
    """Switches at the station."""

    def __init__(self, cell: Cell, *, block: bool, driver: bool) -> None:
        self._cell, self._block, self._driver = cell, block, driver

    def has_block(self) -> bool:
        """Whether a housing lies in the fixture."""
        return self._block

    def has_driver(self) -> bool:
        """Whether the screwdriver stands in its rack."""
        if not self._driver:
            return False
        place = self._cell.truth.box_position("driver")
        return place.z < TABLE_TOP + 0.002 and max(abs(place.x - RACK[0]), abs(place.y - RACK[1])) < 0.002


class Lamp:
    """The lamp of the station that calls for someone to take a reject away.

    Attributes:
        is_on: for tests.
    """

    def __init__(self) -> None:
        self.is_on = False

    def on(self) -> None:
        """Switch it on."""
        self.is_on = True

    def off(self) -> None:
        """Switch it off."""
        self.is_on = False


@dataclass(frozen=True)
class Station:
    """The cell with its equipment.

    Attributes:
        hole: where the hole is, world frame, m; for tests.
    """

    cell: Cell
    clamp: Clamp
    driver: Screwdriver
    inputs: Inputs
    lamp: Lamp
    hole: tuple[float, float]


def build(
    new_cell: Callable[..., Cell],
    seed: int,
    *,
    pin: bool = True,
    block: bool = True,
    cover: bool = True,
    driver: bool = True,
    air: bool = True,
    off: tuple[float, float] | None = None,
    chip: bool = False,
    screw: str = "good",
) -> Station:
    """A station whose fixture has put a housing down a little off, as drawn from the seed.

    Args:
        new_cell: makes the cell.
        pin, block, cover, driver: whether one is in feeder, fixture, tray, rack.
        air: whether the clamp works.
        off: by how much the housing lies off, m, instead of what is drawn.
        chip: whether a chip of 3 mm lies on one of the housing's walls.
        screw: the third one: "good", "crossed", "stripped" or "missing".
    """
    draw = Random(f"block {seed}")
    x, y = off or (draw.uniform(-OFF, OFF), draw.uniform(-OFF, OFF))
    hole = (HOLE[0] + x, HOLE[1] + y)
    table = Fixture("table", (0.8, 1.0, 0.05), (0.5, 0.0, TABLE_TOP - 0.025))
    rests = (TRAY[0] - 0.06, TRAY[0] + 0.06)
    tray = [_bar(f"tray {x:.2f}", (0.02, 0.06, SUPPORT), (x, TRAY[1])) for x in rests]
    rack = _around("rack", HANDLE[0] + RACK_GAP, 0.01, 0.02, RACK)
    parts = (
        Box(
            name="pin", position=(*FEEDER, TABLE_TOP), size=(EDGE, EDGE, LENGTH), mass=PIN_MASS, jitter=0.0003
        ),
        Box(
            name="cover", position=(*TRAY, TABLE_TOP + SUPPORT), size=COVER, mass=COVER_MASS, jitter=0.0002,
            rgba=(0.75, 0.76, 0.78, 1.0),
        ),
        Box(
            name="driver", position=(*RACK, TABLE_TOP), size=HANDLE, mass=0.5, jitter=0.0002,
            rgba=(0.9, 0.55, 0.1, 1.0),
        ),
    )  # fmt: skip
    there = {"pin": pin, "cover": cover, "driver": driver}
    cell = new_cell(
        seed,
        robot=gen3(),
        scene=Scene(
            fixtures=(table, *tray, *rack, *(_housing(hole, chip) if block else ())),
            marks=(),
            parts=tuple(part for part in parts if there[part.name]),
        ),
    )
    threads = [(hole[0] + across, hole[1] + along) for across, along in SCREWS]
    tool = Screwdriver(cell, seed, threads, ["good", "good", screw, "good"], TABLE_TOP + RIM + COVER[2])
    return Station(cell, Clamp(cell, air), tool, Inputs(cell, block=block, driver=driver), Lamp(), hole)


def _housing(hole: tuple[float, float], chip: bool) -> list[Fixture]:
    """The housing: a square hole between two walls that carry the cover."""
    reach = (COVER[0] - RIM_WIDTH) / 2
    ends = (hole[0] - reach, hole[0] + reach)
    walls = [_bar(f"wall {x:.2f}", (RIM_WIDTH, 0.07, RIM), (x, hole[1])) for x in ends]
    if chip:
        size, place = (0.008, 0.008, 0.003), (ends[1], hole[1], TABLE_TOP + RIM + 0.0015)
        walls.append(Fixture("chip", size, place))
    return [*_around("block", EDGE + GAP, BAR, DEPTH, hole), *walls]


def _around(name: str, gap: float, bar: float, height: float, place: tuple[float, float]) -> list[Fixture]:
    """Four bars around a square hole."""
    (x, y), away, long = place, (gap + bar) / 2, gap + 2 * bar
    return [
        _bar(f"{name} +x", (bar, long, height), (x + away, y)),
        _bar(f"{name} -x", (bar, long, height), (x - away, y)),
        _bar(f"{name} +y", (gap, bar, height), (x, y + away)),
        _bar(f"{name} -y", (gap, bar, height), (x, y - away)),
    ]


def _bar(name: str, size: tuple[float, float, float], place: tuple[float, float]) -> Fixture:
    """A block that stands on the table."""
    return Fixture(name, size, (*place, TABLE_TOP + size[2] / 2))
