"""What stands around both robots: tables with bars, the signals between the robots, the zone, and guards.

The equipment is simulated here, as its makers describe it; the programs use what they command and read.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random

from mutabot_cell import Box, Cell, Fixture, Pose, Scene, gen3, robots

BASE_HEIGHT, APART = 0.9, 1.3
"""Of both bases: above the floor and from each other, m. They face each other."""
TABLE_TOP = 1.0
"""Of both tables above the floor, m."""
BAR, BAR_MASS = (0.30, 0.03, 0.05), 0.2
"""Edges and mass of a bar, m and kg: a hollow profile of aluminium."""
LEFT_HOME = (43.0, 19.7, 175.3, -87.8, 1.6, -72.6, 128.1)
RIGHT_HOME = (-225.0, -100.1, 101.8, -91.7, -90.0, -45.0)
"""Where the robots rest, degrees: the grippers look down, above the infeed and beside the middle."""
INFEED, OUTFEED = ((0.45, -0.28), (0.45, -0.42)), ((0.85, 0.28), (0.85, 0.42))
"""Middles of the places for bars, world frame, m."""
BUS_DELAY = (0.01, 0.04)
"""From setting a signal until the other robot reads it, s (our choice: two cycles of 5 to 20 ms)."""
CURTAIN = 1.0
"""From the middle between the robots to the light curtain before the tables, m (our choice)."""
SCANNER_NOISE = 0.02
"""Standard deviation of the laser scanner, m: data sheets of safety scanners say 20 to 30 mm."""

Walk = tuple[tuple[float, float], ...]
"""Where a person is: times, s, and distances from the middle between the robots, m; straight in between."""


class Signals:
    """Bits that one robot sets and both read, over a bus that takes a moment.

    Attributes:
        late: how much longer than usual the bus takes, s; for tests.
    """

    def __init__(self, cell: Cell, seed: int, late: float) -> None:
        self._cell, self._draw, self.late = cell, Random(f"bus {seed}"), late
        self._on: set[str] = set()
        self._sent: list[tuple[float, str, bool]] = []
        cell.simulation.after_tick.append(self._arrive)

    def set(self, name: str) -> None:
        """Switch a signal on; it is read after a moment."""
        self._send(name, True)

    def reset(self, name: str) -> None:
        """Switch a signal off; it is read after a moment."""
        self._send(name, False)

    def is_on(self, name: str) -> bool:
        """Whether the signal is on by what has arrived."""
        return name in self._on

    def all_on(self) -> list[str]:
        """Names of the signals that are on; for tests."""
        return sorted(self._on)

    def _send(self, name: str, value: bool) -> None:
        last = self._sent[-1][0] if self._sent else 0.0  # the bus keeps the order
        self._sent.append(
            (max(last, self._cell.time + self.late + self._draw.uniform(*BUS_DELAY)), name, value)
        )

    def _arrive(self) -> None:
        while self._sent and self._sent[0][0] <= self._cell.time:
            _, name, value = self._sent.pop(0)
            (self._on.add if value else self._on.discard)(name)


class Zone:
    """A space that belongs to at most one robot, as the interlock of the cell's controller grants it.

    Attributes:
        owner: name of a robot, or "" if it is free; for tests.
    """

    def __init__(self) -> None:
        self.owner = ""

    def request(self, robot: str) -> bool:
        """Ask for the zone. Returns whether it belongs to this robot from now on, or already did."""
        if not self.owner:
            self.owner = robot
        return self.owner == robot

    def pass_on(self, robot: str, other: str) -> None:
        """Hand the zone to the other robot, so that it is never free in between."""
        if self.owner == robot:
            self.owner = other

    def release(self, robot: str) -> None:
        """Give the zone back; nothing happens if it belongs to the other robot."""
        if self.owner == robot:
            self.owner = ""


class Guards:
    """A light curtain before the tables, and a laser scanner that sees who comes near."""

    def __init__(self, cell: Cell, seed: int, walk: Walk) -> None:
        self._cell, self._walk, self._noise = cell, walk, Random(f"scanner {seed}")

    def is_clear(self) -> bool:
        """Whether no one has passed the light curtain."""
        return self.true_distance() > CURTAIN

    def distance(self) -> float:
        """From the middle between the robots to the nearest person, m, by the scanner; at most 5."""
        return min(5.0, max(0.0, self.true_distance() + self._noise.gauss(0.0, SCANNER_NOISE)))

    def true_distance(self) -> float:
        """The same without noise; for tests."""
        now = self._cell.time
        for (start, near), (end, far) in zip(self._walk, self._walk[1:], strict=False):
            if start <= now < end:
                return near + (far - near) * (now - start) / (end - start)
        return 5.0


class Outfeed:
    """A sensor that tells whether the place for the next bar is free."""

    def __init__(self, cell: Cell, blocked: tuple[float, float]) -> None:
        self._cell, self._blocked = cell, blocked

    def is_free(self) -> bool:
        """Whether a bar may be put down."""
        return not self._blocked[0] <= self._cell.time < self._blocked[1]


@dataclass(frozen=True)
class Station:
    """The cell with its equipment.

    Attributes:
        seed: of the round.
    """

    cell: Cell
    signals: Signals
    zone: Zone
    guards: Guards
    outfeed: Outfeed
    seed: int


def build(
    new_cell: Callable[..., Cell],
    seed: int,
    *,
    count: int = 2,
    walk: Walk = (),
    late: float = 0.0,
    blocked: tuple[float, float] = (0.0, 0.0),
) -> Station:
    """A Gen3 and a UR5e that face each other, with bars on the table of the first.

    Args:
        new_cell: makes the cell.
        seed: of the round; places of the bars, delays of the bus and the scanner's noise are drawn from it.
        count: of the bars, at most 2.
        walk: of a person.
        late: how much longer than usual the bus takes, s.
        blocked: from when to when no bar may be put down, s.
    """
    tables = (
        Fixture("infeed", (0.5, 0.4, 0.05), (0.45, -0.40, TABLE_TOP - 0.025)),
        Fixture("outfeed", (0.5, 0.4, 0.05), (0.85, 0.40, TABLE_TOP - 0.025)),
    )
    bars = tuple(
        Box(name=f"bar {number}", position=(x, y, TABLE_TOP), size=BAR, mass=BAR_MASS, jitter=0.001)
        for number, (x, y) in enumerate(INFEED[:count])
    )
    facing = Pose(APART, 0.0, BASE_HEIGHT, 0.0, 0.0, 180.0)
    cell = new_cell(
        seed,
        robots={"left": gen3().with_home(LEFT_HOME), "right": robots.ur5e().at(facing).with_home(RIGHT_HOME)},
        scene=Scene(fixtures=tables, marks=(), parts=bars),
    )
    return Station(
        cell, Signals(cell, seed, late), Zone(), Guards(cell, seed, walk), Outfeed(cell, blocked), seed
    )
