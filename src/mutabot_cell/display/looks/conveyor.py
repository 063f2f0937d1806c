"""Draws a conveyor: a belt round two rollers, side rails, drive, stand."""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco

from mutabot_cell.scene import Fixture

from .furniture import add_stand
from .style import ALONG_X, ALONG_Y, BOX, CYLINDER, hide, named, show

_START = -0.6
"""Where the seam is at first, as a share of the way from the middle to the roller."""
_RAIL, _SEAM, _SKIN = 0.035, 0.012, 0.0004
"""Width of a side rail and of the seam, and how far the seam is above the belt, m."""


@dataclass(frozen=True, slots=True)
class Seam:
    """The seam of a belt, which moves with it.

    Attributes:
        name: of the belt's fixture.
        along: axis of the fixture along which the belt runs, 0 or 1.
        sign: of that axis for positive speed.
        end: from the middle to the axis of a roller, m.
        radius: of a roller, m.
    """

    name: str
    along: int
    sign: float
    end: float
    radius: float

    def pose(self, model: mujoco.MjModel, travel: float) -> None:
        """Move the seam to where it is after `travel` m; it is hidden below the belt."""
        loop = 4 * self.end + 2 * math.pi * self.radius
        place = (_START * self.end + self.sign * travel + self.end) % loop - self.end
        is_above = place <= self.end
        where = model.geom(named(f"seam of {self.name}")).pos
        where[self.along] = place if is_above else 0.0
        where[2] = self.radius if is_above else 0.0


def dress_belt(spec: mujoco.MjSpec, fixture: Fixture) -> Seam:
    """Draw a fixture as a conveyor with the same surface; return the seam, to be posed."""
    assert fixture.belt is not None
    body = spec.body(fixture.name)
    hide(spec.geom(fixture.name))
    along_x = abs(fixture.belt.direction[0]) > abs(fixture.belt.direction[1])
    length, width = (fixture.size[0], fixture.size[1]) if along_x else (fixture.size[1], fixture.size[0])
    draw = _ConveyorAxes(body, along_x)
    radius = fixture.size[2] / 2
    inside, end = width / 2 - _RAIL, length / 2 - radius
    draw.box((end, inside, radius), (0, 0, 0), "belt")
    for side in (-1, 1):
        draw.roller(radius, inside, (side * end, 0, 0), "belt")
        rail = side * (width / 2 - _RAIL / 2)
        draw.box((end + radius * 0.55, _RAIL / 2, radius * 0.92), (0, rail, -radius * 0.06), "aluminium")
        draw.box((end + radius * 0.5, 0.0015, 0.004), (0, side * (width / 2), 0.012), "black")
        draw.box((end + radius * 0.5, 0.0015, 0.004), (0, side * (width / 2), -0.022), "black")
        for tip in (-1, 1):
            draw.roller(radius * 0.5, 0.006, (tip * end, side * (width / 2 + 0.005), 0), "steel")
            draw.roller(radius * 0.2, 0.012, (tip * end, side * (width / 2 + 0.005), 0), "black")
    draw.box((_SEAM / 2, inside, _SKIN), (0, 0, radius), "seam").name = named(f"seam of {fixture.name}")
    draw.box((0.09, 0.07, 0.05), (0.78 * end, -width / 2 + 0.14, -radius - 0.05), "blue")
    draw.roller(0.045, 0.09, (0.78 * end, -width / 2 + 0.29, -radius - 0.05), "anthracite")
    add_stand(body, fixture, inset=0.16)
    axis = 0 if along_x else 1
    return Seam(fixture.name, axis, math.copysign(1.0, fixture.belt.direction[axis]), end, radius)


class _ConveyorAxes:
    """Draws in a conveyor's own axes: along it, across it, up."""

    def __init__(self, body: mujoco.MjsBody, along_x: bool) -> None:
        self._body, self._along_x = body, along_x

    def box(
        self, size: tuple[float, float, float], pos: tuple[float, float, float], material: str
    ) -> mujoco.MjsGeom:
        """Draw a block, given its half edges."""
        return show(self._body, BOX, self._turned(size), self._turned(pos), material=material)

    def roller(self, radius: float, half: float, pos: tuple[float, float, float], material: str) -> None:
        """Draw a cylinder across the conveyor."""
        quat = ALONG_Y if self._along_x else ALONG_X
        show(self._body, CYLINDER, (radius, half, 0.0), self._turned(pos), material=material, quat=quat)

    def _turned(self, values: tuple[float, float, float]) -> tuple[float, float, float]:
        along, across, up = values
        return (along, across, up) if self._along_x else (across, along, up)
