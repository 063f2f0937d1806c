"""What stands around the robot: a fixture with a housing, a dispenser, and a sensor that finds the seam.

The equipment is simulated here, as its makers describe it; the program uses what it commands and reads.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from random import Random

from mutabot_cell import Cell, Fixture, Pose, Scene, gen3, nozzle

BASE_HEIGHT = 0.9
"""Of the robot's base above the floor, m."""
FLOW = 3.77e-7
"""Of the open dispenser, m³/s (our choice): at 60 mm/s half a cylinder 4 mm wide."""
DEAD_TIME, RISE = 0.02, 0.03
"""From the valve's command until the flow begins to change, and its time constant, s (our choice)."""
PRESSURE, CLOG_RISE = 4.0e5, 4.0e6
"""Before the open needle, Pa; and how fast it rises before a clogged one, Pa/s (our choice)."""
REACHES, STRINGS = 0.006, 0.0005
"""From higher the sealant falls beside the seam, from lower it smears, m (our choice)."""
CARTRIDGE = 3.0e-4
"""A full one holds this, m³: a usual size."""
SENSOR_RANGE, SENSOR_NEAR, SENSOR_FAR = 0.0125, 0.005, 0.045
"""Of the seam sensor: to either side, and from the nozzle's tip to the surface, m."""
SENSOR_NOISE = 0.00005
"""Standard deviation of both its readings, m: 25 mm by 640 points make 0.04 mm a point."""
HOUSING = (0.16, 0.24, 0.03)
"""Edges of the housing, m."""


@dataclass(frozen=True)
class Housing:
    """Where a housing lies: the middle of its top in the base frame, m, and its turn, degrees."""

    x: float
    y: float
    z: float
    turn: float

    def place(self, x: float, y: float) -> tuple[float, float]:
        """A place of the base frame in the housing's frame, m."""
        turned, x, y = math.radians(self.turn), x - self.x, y - self.y
        return x * math.cos(turned) + y * math.sin(turned), y * math.cos(turned) - x * math.sin(turned)


@dataclass(frozen=True)
class Drop:
    """What left the nozzle in a tick.

    Attributes:
        x, y, height: where, in the housing's frame, m.
        volume: m³.
        time: simulated, s.
    """

    x: float
    y: float
    height: float
    volume: float
    time: float


@dataclass(frozen=True)
class Profile:
    """What the sensor measures: how far aside the seam lies, along its line, and how far down the surface is.

    Attributes:
        offset: m, positive towards the sensor's x axis.
        distance: from the nozzle's tip, m.
    """

    offset: float
    distance: float


class Dispenser:
    """A dispenser with a needle valve; what leaves it is noted drop by drop.

    Attributes:
        drops: all that was dispensed; for tests.
    """

    def __init__(self, cell: Cell, housing: Housing | None, level: float, clogs_at: float) -> None:
        self._cell, self._housing, self._level, self._clogs_at = cell, housing, level, clogs_at
        self._is_open, self._flow, self._pressure = False, 0.0, PRESSURE
        self._commands: list[tuple[float, bool]] = []
        self._opened = 0.0
        self._last = cell.time
        self.drops: list[Drop] = []
        cell.simulation.after_tick.append(self._tick)

    def open(self) -> None:
        """Open the valve; the sealant flows after a moment."""
        self._commands.append((self._cell.time + DEAD_TIME, True))

    def close(self) -> None:
        """Shut the valve; the sealant stops after a moment."""
        self._commands.append((self._cell.time + DEAD_TIME, False))

    def level(self) -> float:
        """What is left in the cartridge, as part of a full one."""
        return self._level

    def pressure(self) -> float:
        """Before the needle, Pa."""
        return self._pressure

    def _tick(self) -> None:
        now, passed = self._cell.time, self._cell.time - self._last
        self._last = now
        while self._commands and self._commands[0][0] <= now:
            self._is_open = self._commands.pop(0)[1]
        is_clogged = self._opened > self._clogs_at
        self._opened += passed if self._is_open else 0.0
        wanted = FLOW if self._is_open and not is_clogged and self._level > 0.0 else 0.0
        self._flow += (wanted - self._flow) * (1.0 - math.exp(-passed / RISE))
        rising = CLOG_RISE * passed if self._is_open and is_clogged else 0.0
        self._pressure = self._pressure + rising if rising else PRESSURE
        volume = self._flow * passed
        if volume > 1e-3 * FLOW * passed > 0.0:
            self._level = max(0.0, self._level - volume / CARTRIDGE)
            tip = self._cell.truth.tool_position()
            lies = self._housing or Housing(0.0, 0.0, 0.0, 0.0)
            self.drops.append(Drop(*lies.place(tip.x, tip.y), tip.z - lies.z, volume, now))


class SeamSensor:
    """A laser draws a line along the tool's x axis; the sensor sees where a groove crosses it."""

    def __init__(
        self, cell: Cell, housing: Housing | None, seam: list[tuple[float, float]], seed: int
    ) -> None:
        self._cell, self._housing, self._seam = cell, housing, seam
        self._noise = Random(f"seam sensor {seed}")

    def read(self) -> Profile | None:
        """What it measures here; None if no groove is in its range."""
        tip = self._cell.truth.tool_pose()
        if self._housing is None:
            return None
        offset, height = self._crossing(tip), tip.z - self._housing.z
        if offset is None or not SENSOR_NEAR < height < SENSOR_FAR:
            return None
        return Profile(*(value + self._noise.gauss(0.0, SENSOR_NOISE) for value in (offset, height)))

    def _crossing(self, tip: Pose) -> float | None:
        """Where the nearest crossing of groove and line is, along the line, m."""
        assert self._housing is not None
        x, y = self._housing.place(tip.x, tip.y)
        angle = math.radians(tip.theta_z - self._housing.turn)
        ahead = math.cos(angle), math.sin(angle)
        found: list[float] = []
        for (x0, y0), (x1, y1) in zip(self._seam, self._seam[1:], strict=False):
            side = (x1 - x0, y1 - y0)
            cross = ahead[0] * side[1] - ahead[1] * side[0]
            if abs(cross) < 1e-9:
                continue
            along = ((x0 - x) * side[1] - (y0 - y) * side[0]) / cross
            part = ((x0 - x) * ahead[1] - (y0 - y) * ahead[0]) / cross
            if 0.0 <= part <= 1.0 and abs(along) <= SENSOR_RANGE:
                found.append(along)
        return min(found, key=abs, default=None)


@dataclass
class Station:
    """The cell with its equipment.

    Attributes:
        housing: where it lies; None: the fixture is empty. For tests.
        seam: corners of its groove, in its frame, m. For tests.
    """

    cell: Cell
    dispenser: Dispenser
    seam_sensor: SeamSensor
    housing: Housing | None
    seam: list[tuple[float, float]] = field(default_factory=list)


def build(
    new_cell: Callable[..., Cell],
    seed: int,
    nominal: Housing,
    seam: list[tuple[float, float]],
    *,
    is_empty: bool = False,
    shift: tuple[float, float] | None = None,
    level: float = 0.8,
    clogs_at: float = math.inf,
) -> Station:
    """A station whose fixture has put a housing down a little off, as drawn from the seed.

    Args:
        new_cell: makes the cell.
        nominal: where the housing should lie.
        seam: corners of its groove.
        is_empty: no housing lies there.
        shift: by how much it lies off, m, instead of what is drawn.
        level: of the cartridge, as part of a full one.
        clogs_at: after so long with an open valve the needle clogs, s.
    """
    draw = Random(f"housing {seed}")
    x, y = shift or (draw.uniform(-0.003, 0.003), draw.uniform(-0.003, 0.003))
    height, turn = draw.uniform(-0.001, 0.001), draw.uniform(-1.0, 1.0)
    lies = Housing(nominal.x + x, nominal.y + y, nominal.z + height, turn)
    top = BASE_HEIGHT + lies.z
    table = Fixture("table", (0.5, 0.8, 0.05), (nominal.x, nominal.y, top - HOUSING[2] - 0.025))
    part = Fixture(
        "housing", HOUSING, (lies.x, lies.y, top - HOUSING[2] / 2), (0.8, 0.8, 0.85, 1.0), angles=(0, 0, turn)
    )
    fixtures = (table,) if is_empty else (table, part)
    scene = Scene(fixtures=fixtures, marks=(), parts=())
    cell = new_cell(seed, robot=gen3().with_tool(nozzle()), scene=scene)
    housing = None if is_empty else lies
    dispenser = Dispenser(cell, housing, level, clogs_at)
    return Station(cell, dispenser, SeamSensor(cell, housing, seam, seed), housing, seam)
