"""The suction cup as robot programs use it: on, off, and its vacuum sensor.

Nothing ties a part to the cup. The vacuum presses it against the lip with pressure times area; the lip's
friction carries it sideways; and where the lip does not touch, air comes in.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np

from mutabot_cell.models.effectors import SEALED_GAP, SuctionCup
from mutabot_cell.models.noise import SeededNoise
from mutabot_cell.models.vacuum import Vacuum

from .geometry import Array
from .lookahead import QuickCheck
from .robot import Robot
from .simulation import TICK, Simulation
from .stretch import LONGEST

SWITCHING_POINT, HYSTERESIS = 55e3, 1e3
"""Vacuum above which it reports a part, and by how much less it must be to report none, Pa: the factory
settings H2 and h2 of Schmalz's compact terminals."""

_NEGLIGIBLE = 10.0
_CENTROID = 2 / 3
_FAR = (math.inf, -1)


class Suction:
    """A suction cup with an ejector and a vacuum sensor.

    Attributes:
        leak: opening that a worn lip or a porous part leaves although the cup seals, m².
    """

    def __init__(self, simulation: Simulation, robot: Robot, cup: SuctionCup, noise: SeededNoise) -> None:
        self._simulation = simulation
        self._noise = noise
        self._vacuum = Vacuum(cup.ejector)
        self.leak = cup.leak
        self._area = cup.area
        self._arc = math.pi * cup.diameter / len(cup.lip)
        self._is_on = False
        self._has_part = False
        self._read: tuple[int, float] = (-1, 0.0)
        model = simulation.model
        self._cup = simulation.id_of("body", robot.prefix + cup.body)
        geoms = [int(model.geom(robot.prefix + name).id) for name in cup.lip]
        self._points = {geom: number for number, geom in enumerate(geoms)}
        self._sectors = model.geom_pos[geoms] * (_CENTROID, _CENTROID, 0.0)
        self._bodies = model.geom_bodyid.tolist()
        self._pulled: list[int] = []
        self._dofs = robot.dofs
        self._torque = np.zeros(model.nv)
        simulation.after_tick.append(self._pull)
        simulation.lookahead.add_check(self._pull, QuickCheck(lambda: 1 if self._acts() else LONGEST))

    def on(self) -> None:
        """Start the ejector. Return at once; the vacuum comes within some tenths of a second."""
        self._is_on = True

    def off(self) -> None:
        """Stop the ejector and let air in. Return at once."""
        self._is_on = False

    def is_on(self) -> bool:
        """Return whether the ejector is commanded to draw."""
        return self._is_on

    def vacuum(self) -> float:
        """Return what the vacuum sensor reads, Pa below the atmosphere, with noise; one reading per tick."""
        ticks, reading = self._read
        if ticks != self._simulation.ticks:
            reading = self._noise.add("vacuum", self._vacuum.pressure)
            self._read = self._simulation.ticks, reading
        return reading

    def holding(self) -> bool:
        """Return whether the sensor's switch reports a part: above 55 kPa, until it falls below 54 kPa."""
        return self._has_part

    def true_vacuum(self) -> float:
        """Return the exact vacuum, Pa; for checks."""
        return self._vacuum.pressure

    def arm_torque(self) -> Array:
        """Return the torque of the vacuum's pull on each joint of the arm, shape (joints,), Nm.

        Together with the lip's contacts it makes what the part weighs on the cup.
        """
        model, data = self._simulation.model, self._simulation.data
        self._torque[:] = 0.0
        if self._pulled:
            force = data.xfrc_applied[self._cup]
            mujoco.mj_applyFT(
                model, data, force[:3], force[3:], data.xipos[self._cup], self._cup, self._torque
            )
        return self._torque[self._dofs]

    def _acts(self) -> bool:
        """Return whether it draws, presses or has a vacuum; otherwise nothing changes with time."""
        return self._is_on or bool(self._pulled) or self._vacuum.pressure != 0.0

    def _pull(self) -> None:
        if not self._acts():
            return
        touched, opening = self._touched()
        self._vacuum.advance(TICK, self.leak + opening, is_on=self._is_on)
        if not self._is_on and self._vacuum.pressure < _NEGLIGIBLE:
            self._vacuum.pressure = 0.0
        limit = SWITCHING_POINT - (HYSTERESIS if self._has_part else 0.0)
        self._has_part = self._vacuum.pressure > limit
        self._press(touched)

    def _touched(self) -> tuple[dict[int, list[int]], float]:
        """Return the lip's points on each body that it (nearly) touches, and the opening that is left, m²."""
        contact, points, bodies = self._simulation.data.contact, self._points, self._bodies
        nearest: dict[int, tuple[float, int]] = {}
        for (first, second), distance in zip(contact.geom.tolist(), contact.dist.tolist(), strict=True):
            own, touched = (first, second) if first in points else (second, first)
            if own in points and distance < nearest.get(own, _FAR)[0]:
                nearest[own] = distance, bodies[touched]
        found: dict[int, list[int]] = {}
        opening = (len(self._points) - len(nearest)) * self._area / len(self._points)
        for geom, (distance, body) in nearest.items():
            found.setdefault(body, []).append(points[geom])
            opening += self._arc * max(0.0, distance - SEALED_GAP)
        return found, opening

    def _press(self, touched: dict[int, list[int]]) -> None:
        """Press the cup and what it touches together: each sector with pressure times its area."""
        data = self._simulation.data
        for body in self._pulled:
            data.xfrc_applied[body] = 0.0
        self._pulled = [self._cup, *touched] if touched else []
        axes, centre = data.xmat[self._cup].reshape(3, 3), data.xpos[self._cup]
        share = self._vacuum.pressure * self._area / len(self._points) * axes[:, 2]
        for body, points in touched.items():
            place = centre
            if len(points) < len(self._points):
                place = centre + axes @ self._sectors[points].mean(axis=0)
            force = len(points) * share
            self._add(self._cup, force, place)
            self._add(body, -force, place)

    def _add(self, body: int, force: Array, place: Array) -> None:
        data = self._simulation.data
        (fx, fy, fz), (x, y, z) = force.tolist(), (place - data.xipos[body]).tolist()
        data.xfrc_applied[body] += (fx, fy, fz, y * fz - z * fy, z * fx - x * fz, x * fy - y * fx)
