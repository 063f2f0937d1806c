"""An electric screwdriver that stands in a rack, with screws that are blown into its nose.

The nose rests on the cover; the bit comes out of it, turns the screw, and presses it with a force of its own.
What the screw resists acts on the screwdriver's housing, so on whoever holds it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random

from mutabot_cell import Cell

HANDLE, BESIDE = (0.024, 0.024, 0.14), 0.0015
"""Edges of the screwdriver; how far beside a thread nose and cover may lie for the screw to find it, m."""
BIT_FORCE = 8.0
"""With which the bit presses, N."""
FREE_TORQUE, STIFFNESS = 0.10, 2.0
"""Of a screw while it runs freely, Nm, and when its head rests, Nm/rad (our choice: M5, spring washer)."""
SEATS_AT, CROSSED_AT, STRIPPED_TORQUE = 8.0 * math.pi, 1.5 * math.pi, 1.2
"""After so much turning the head rests, or a crossed screw jams, rad; a stripped thread gives way, Nm."""
TORQUE_NOISE, LIFTED = 0.02, 0.001
"""Standard deviation of the torque sensor, Nm: 0.5 % of 4 Nm; a nose so far off the cover turns none, m."""


@dataclass
class Screw:
    """A screw with its thread in the housing.

    Attributes:
        place: of the thread, world frame, m.
        kind: "good", "crossed", "stripped" or "missing".
        seats: after so much turning its head rests, rad.
        angle: by which it has been turned, rad.
        tightest: greatest torque that it has taken, Nm; for tests.
    """

    place: tuple[float, float]
    kind: str
    seats: float
    angle: float = 0.0
    tightest: float = 0.0

    def torque(self) -> float:
        """By which it resists, Nm."""
        if self.kind == "missing":
            return 0.0
        rests = CROSSED_AT if self.kind == "crossed" else self.seats
        torque = FREE_TORQUE + STIFFNESS * max(0.0, self.angle - rests)
        return min(torque, STRIPPED_TORQUE) if self.kind == "stripped" else torque


class Screwdriver:
    """The screwdriver.

    Attributes:
        screws: for tests.
        order: in which they were turned first; for tests.
    """

    def __init__(
        self, cell: Cell, seed: int, threads: list[tuple[float, float]], kinds: list[str], top: float
    ) -> None:
        draw = Random(f"screws {seed}")
        self.screws = [
            Screw(place, kind, SEATS_AT + draw.uniform(-0.5, 0.5))
            for place, kind in zip(threads, kinds, strict=True)
        ]
        self.order: list[int] = []
        self._cell, self._top, self._noise = cell, top, Random(f"screwdriver {seed}")
        self._middle = tuple(sum(values) / len(threads) for values in zip(*threads, strict=True))
        self._speed = self._angle = self._torque = 0.0

    def start(self, speed: float) -> None:
        """Turn at a speed, rad/s, clockwise, until it is stopped; from standing the angle counts anew."""
        hooks = self._cell.simulation.after_tick
        if self._tick not in hooks:
            hooks.append(self._tick)
            self._angle = 0.0
        self._speed = speed

    def stop(self) -> None:
        """Stand still, and draw the bit back."""
        self._speed = 0.0
        hooks = self._cell.simulation.after_tick
        if self._tick in hooks:
            hooks.remove(self._tick)
            self._push(0.0, 0.0)
        self._torque = 0.0

    def angle(self) -> float:
        """How far it has turned since it was started, rad."""
        return self._angle

    def torque(self) -> float:
        """With which it turns, Nm, with noise."""
        return self._torque + self._noise.gauss(0.0, TORQUE_NOISE)

    @property
    def is_turning(self) -> bool:
        """Whether it turns; for tests."""
        return self._speed != 0.0

    def screw_below(self) -> int | None:
        """The number of the screw over whose thread nose and cover rest; for tests."""
        truth = self._cell.truth
        nose, cover = truth.box_position("driver"), truth.box_position("cover")
        if abs(nose.z - self._top) > LIFTED or math.dist((cover.x, cover.y), self._middle) > BESIDE:
            return None
        away = [math.dist((nose.x, nose.y), screw.place) for screw in self.screws]
        return min(range(len(away)), key=away.__getitem__) if min(away) < BESIDE else None

    def _tick(self) -> None:
        """Turn by 10 ms; the screwdriver's own turning in the gripper is lost."""
        data = self._cell.simulation.data
        turned = (self._speed - float(data.joint("driver").qvel[5])) * 0.01
        self._angle += self._speed * 0.01
        number = self.screw_below()
        if number is None:
            self._torque = 0.0
            self._push(0.0, 0.0)
            return
        if number not in self.order:
            self.order.append(number)
        screw = self.screws[number]
        screw.angle += turned
        self._torque = screw.torque()
        screw.tightest = max(screw.tightest, self._torque)
        self._push(BIT_FORCE, self._torque)

    def _push(self, force: float, torque: float) -> None:
        """The screw pushes the screwdriver up and turns it back; it presses the cover down."""
        data = self._cell.simulation.data
        data.xfrc_applied[self._cell.simulation.id_of("body", "driver")] = (0, 0, force, 0, 0, torque)
