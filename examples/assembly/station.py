"""What stands around the robot: a feeder with a pin, a fixture with a block, a screw spindle, a chute.

The equipment is simulated here, as its makers describe it; the program uses what it commands and reads.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from random import Random

from mutabot_cell import Box, Cell, Fixture, Scene, gen3

BASE_HEIGHT, TABLE_TOP = 0.9, 1.0
"""Of the robot's base and of the table above the floor, m."""
EDGE, LENGTH, PIN_MASS = 0.02, 0.08, 0.05
"""Edge, length, m, and mass, kg, of a pin."""
GAP, DEPTH = 0.0008, 0.025
"""Clearance of the block's hole, both sides together, and its depth, m."""
HOLE, FEEDER, CHUTE = (0.50, 0.10), (0.50, -0.10), (0.40, -0.30)
"""Where the hole and the pin should be, and where rejects are dropped; world frame, m."""
OFF, BAR = 0.001, 0.04
"""The fixture puts a block down no further off than this; and the thickness of its sides, m."""
FREE_TORQUE, STIFFNESS = 0.10, 2.0
"""Of the screw while it runs freely, Nm, and when its head rests, Nm/rad (our choice: M5 in steel)."""
SEATS_AT, CROSSED_AT = 9.0 * math.pi, 1.5 * math.pi
"""After so much turning the head rests; a screw that is crossed jams, rad."""
STRIPPED_TORQUE = 1.2
"""A stripped thread gives way at this torque, Nm."""
TORQUE_NOISE = 0.02
"""Standard deviation of the spindle's torque, Nm: 0.5 % of a range of 4 Nm."""


class Spindle:
    """A screw spindle at the fixture: it drives a set screw through the block's side against the pin.

    Attributes:
        tightest: greatest torque that the screw has taken, Nm; for tests.
    """

    def __init__(self, cell: Cell, seed: int, screw: str) -> None:
        self._cell, self._screw, self._noise = cell, screw, Random(f"spindle {seed}")
        self._seats = SEATS_AT + Random(f"screw {seed}").uniform(-0.5, 0.5)
        self._speed = self._angle = self.tightest = 0.0
        self._last = cell.time
        cell.simulation.after_tick.append(self._tick)

    def start(self, speed: float) -> None:
        """Turn at a speed, rad/s, clockwise, until it is stopped."""
        self._speed = speed

    def stop(self) -> None:
        """Stand still."""
        self._speed = 0.0

    def angle(self) -> float:
        """How far it has turned, rad."""
        return self._angle

    def torque(self) -> float:
        """Of the screw, Nm, with noise."""
        return self.true_torque() + self._noise.gauss(0.0, TORQUE_NOISE)

    def true_torque(self) -> float:
        """The same without noise; for tests."""
        if self._screw == "missing":
            return 0.0
        rests = CROSSED_AT if self._screw == "crossed" else self._seats
        torque = FREE_TORQUE + STIFFNESS * max(0.0, self._angle - rests)
        return min(torque, STRIPPED_TORQUE) if self._screw == "stripped" else torque

    @property
    def is_turning(self) -> bool:
        """Whether it turns; for tests."""
        return self._speed != 0.0

    def _tick(self) -> None:
        self._angle += self._speed * (self._cell.time - self._last)
        self._last = self._cell.time
        self.tightest = max(self.tightest, self.true_torque())


class Inputs:
    """Switches at the station."""

    def __init__(self, *, block: bool) -> None:
        self._block = block

    def has_block(self) -> bool:
        """Whether a block lies in the fixture."""
        return self._block


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
    spindle: Spindle
    inputs: Inputs
    lamp: Lamp
    hole: tuple[float, float]


def build(
    new_cell: Callable[..., Cell],
    seed: int,
    *,
    pin: bool = True,
    block: bool = True,
    off: tuple[float, float] | None = None,
    screw: str = "good",
) -> Station:
    """A station whose fixture has put a block down a little off, as drawn from the seed.

    Args:
        new_cell: makes the cell.
        pin: whether one is in the feeder.
        block: whether one is in the fixture.
        off: by how much it lies off, m, instead of what is drawn.
        screw: "good", "crossed", "stripped" or "missing".
    """
    draw = Random(f"block {seed}")
    x, y = off or (draw.uniform(-OFF, OFF), draw.uniform(-OFF, OFF))
    hole = (HOLE[0] + x, HOLE[1] + y)
    table = Fixture("table", (0.8, 1.0, 0.05), (0.5, 0.0, TABLE_TOP - 0.025))
    part = Box(
        name="pin",
        position=(*FEEDER, TABLE_TOP),
        size=(EDGE, EDGE, LENGTH),
        mass=PIN_MASS,
        jitter=0.0003,
        colour="blue",
    )
    cell = new_cell(
        seed,
        robot=gen3(),
        scene=Scene(
            fixtures=(table, *(sides(hole) if block else ())), marks=(), parts=(part,) if pin else ()
        ),
    )
    return Station(cell, Spindle(cell, seed, screw), Inputs(block=block), Lamp(), hole)


def sides(hole: tuple[float, float]) -> tuple[Fixture, ...]:
    """The block: four bars around a square hole."""
    half, (x, y), height = (EDGE + GAP) / 2, hole, TABLE_TOP + DEPTH / 2
    long = 2 * half + 2 * BAR
    return (
        Fixture("block +x", (BAR, long, DEPTH), (x + half + BAR / 2, y, height)),
        Fixture("block -x", (BAR, long, DEPTH), (x - half - BAR / 2, y, height)),
        Fixture("block +y", (2 * half, BAR, DEPTH), (x, y + half + BAR / 2, height)),
        Fixture("block -y", (2 * half, BAR, DEPTH), (x, y - half - BAR / 2, height)),
    )
