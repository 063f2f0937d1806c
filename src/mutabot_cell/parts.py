"""Loose parts, as plain data: boxes, cylinders and meshes.

Lengths in m, angles in degrees, masses in kg; world frame with z up.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

Vector3 = tuple[float, float, float]

BOX_EDGE = 0.05
RED_RGBA = (0.78, 0.13, 0.12, 1.0)
BLUE_RGBA = (0.13, 0.30, 0.75, 1.0)
_SEEN = 0.9
"""The camera looks for points of a part that are this share of the way from its middle to its surface."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Part(ABC):
    """A loose part.

    Attributes:
        position: of the lowest point below its middle, world frame: what it rests on.
        angles: Euler angles x, y, z.
        colour: "red", "blue", or None to draw it from the round's seed.
        rgba: how it looks, 0..1 each; None for its colour.
        centre_of_mass: from the middle of the part; None where the mass of a uniform one is.
        friction: sliding friction coefficient of every contact of this part, for one that is oily or wet;
            None for dry cardboard or wood, whose coefficients are those of what it touches.
        jitter: standard deviation of the placement in x and y; draws beyond two of it are cut.
    """

    name: str = "box"
    position: Vector3 = (0.55, 0.2, 1.0)
    angles: Vector3 = (0.0, 0.0, 0.0)
    colour: str | None = None
    rgba: tuple[float, float, float, float] | None = None
    mass: float = 0.1
    centre_of_mass: Vector3 | None = None
    friction: float | None = None
    jitter: float = 0.0005

    @property
    @abstractmethod
    def extent(self) -> Vector3:
        """Edges of the smallest upright box around the part before it is turned, m."""

    @abstractmethod
    def reach(self, direction: Vector3) -> float:
        """Return how far the part extends from its centre along a unit direction in its own frame, m."""

    @abstractmethod
    def points(self) -> tuple[Vector3, ...]:
        """Return points within the part, near its surface, and its centre, for the camera; m, own frame."""

    @property
    def foot(self) -> Vector3:
        """The vector from the centre to where the part first rests, below it, in its own frame, m."""
        (x, y, z), height = self.up, self.middle_height
        return (-height * x, -height * y, -height * z)

    @property
    def middle_height(self) -> float:
        """The height of its centre at first above what it rests on, m."""
        return self.reach(self.up)

    @property
    def up(self) -> Vector3:
        """The world's up in the part's own frame as it is placed."""
        (sx, cx), (sy, cy) = ((math.sin(math.radians(a)), math.cos(math.radians(a))) for a in self.angles[:2])
        return (-sy, cy * sx, cy * cx)

    @property
    def looks(self) -> tuple[float, float, float, float]:
        """Its red, green, blue and opacity, 0..1."""
        return self.rgba or (RED_RGBA if self.colour == "red" else BLUE_RGBA)


@dataclass(frozen=True, slots=True, kw_only=True)
class Box(Part):
    """A block with three edges, m."""

    size: Vector3 = (BOX_EDGE, BOX_EDGE, BOX_EDGE)

    @property
    def extent(self) -> Vector3:
        """Its edges, m."""
        return self.size

    def reach(self, direction: Vector3) -> float:
        """Return half of the extent of the block along a direction, m."""
        return sum(abs(part) * edge / 2 for part, edge in zip(direction, self.size, strict=True))

    def points(self) -> tuple[Vector3, ...]:
        """Return its centre, and points close to its corners."""
        return _corners(self.size)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cylinder(Part):
    """A round bar or disc that stands on its base; turned by 90° about x or y it lies and rolls."""

    diameter: float = 0.05
    height: float = 0.05

    @property
    def extent(self) -> Vector3:
        """Diameter, diameter and height, m."""
        return (self.diameter, self.diameter, self.height)

    def reach(self, direction: Vector3) -> float:
        """Return the distance to the farthest point of the upper or lower rim, m."""
        x, y, z = direction
        return math.hypot(x, y) * self.diameter / 2 + abs(z) * self.height / 2

    def points(self) -> tuple[Vector3, ...]:
        """Return its centre, and four points close to each rim."""
        edge = self.diameter / math.sqrt(2)
        return _corners((edge, edge, self.height))


@dataclass(frozen=True, slots=True, kw_only=True)
class Mesh(Part):
    """The convex hull of points, around the middle of its bounding box; `read_mesh` reads them from a file.

    Attributes:
        vertices: at least four that do not lie in one plane, m.
    """

    vertices: tuple[Vector3, ...]

    @property
    def extent(self) -> Vector3:
        """Edges of the bounding box, m."""
        low, high = self._bounds()
        return (high[0] - low[0], high[1] - low[1], high[2] - low[2])

    def centred(self) -> tuple[Vector3, ...]:
        """Return the points relative to the centre of the bounding box, m."""
        low, high = self._bounds()
        middle = [(first + second) / 2 for first, second in zip(low, high, strict=True)]
        return tuple((x - middle[0], y - middle[1], z - middle[2]) for x, y, z in self.vertices)

    def reach(self, direction: Vector3) -> float:
        """Return the distance to the point that is farthest along a direction, m."""
        return max(_along(point, direction) for point in self.centred())

    def points(self) -> tuple[Vector3, ...]:
        """Return its centre, and points close to the farthest ones along the diagonals."""
        points = self.centred()
        far = [max(points, key=partial(_along, way)) for way in _corners((1.0, 1.0, 1.0))[1:]]
        return ((0.0, 0.0, 0.0), *((x * _SEEN, y * _SEEN, z * _SEEN) for x, y, z in far))

    def _bounds(self) -> tuple[Vector3, Vector3]:
        columns: Any = list(zip(*self.vertices, strict=True))
        return tuple(map(min, columns)), tuple(map(max, columns))


def _along(first: Vector3, second: Vector3) -> float:
    return first[0] * second[0] + first[1] * second[1] + first[2] * second[2]


def _corners(edges: Vector3) -> tuple[Vector3, ...]:
    halves: Iterable[Vector3] = (
        (x * edges[0] / 2 * _SEEN, y * edges[1] / 2 * _SEEN, z * edges[2] / 2 * _SEEN)
        for x in (-1, 1)
        for y in (-1, 1)
        for z in (-1, 1)
    )
    return ((0.0, 0.0, 0.0), *halves)
