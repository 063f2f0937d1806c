"""What stands in the cell, as plain data.

Lengths in m, angles in degrees, masses in kg; world frame with z up.
"""

from __future__ import annotations

from dataclasses import dataclass, field

BASE_POSITION = (0.0, 0.0, 0.9)
"""Where the robot's base stands in the world, m."""

BOX_EDGE = 0.05
RED_RGBA = (0.78, 0.13, 0.12, 1.0)
BLUE_RGBA = (0.13, 0.30, 0.75, 1.0)


@dataclass(frozen=True, slots=True)
class Fixture:
    """A block that never moves: conveyor, table, wall. `size` holds full edge lengths."""

    name: str
    size: tuple[float, float, float]
    centre: tuple[float, float, float]
    rgba: tuple[float, float, float, float] = (0.6, 0.6, 0.62, 1.0)


@dataclass(frozen=True, slots=True)
class Mark:
    """A flat coloured patch without a body. `size` holds full edge lengths in x and y."""

    name: str
    size: tuple[float, float]
    centre: tuple[float, float, float]
    rgba: tuple[float, float, float, float] = (0.8, 0.1, 0.1, 1.0)


@dataclass(frozen=True, slots=True)
class Box:
    """A loose cube.

    Attributes:
        position: middle of the bottom face, world frame.
        colour: "red", "blue", or None to draw it from the round's seed.
        jitter: standard deviation of the placement in x and y, m; draws beyond two of it are cut.
        friction: sliding friction coefficient of every contact of this box.
    """

    name: str = "box"
    position: tuple[float, float, float] = (0.55, 0.2, 1.0)
    yaw: float = 0.0
    colour: str | None = None
    edge: float = BOX_EDGE
    mass: float = 0.1
    friction: float = 1.0
    jitter: float = 0.0005


CONVEYOR = Fixture("conveyor", (1.0, 2.5, 0.1), (0.6, 0.0, 0.95), (0.27, 0.29, 0.31, 1.0))
TARGET_TABLE = Fixture("target table", (0.8, 1.6, 0.06), (-0.6, 0.0, 0.73), (0.72, 0.60, 0.44, 1.0))
RED_TARGET = Mark("red target", (0.10, 0.10), (-0.4, 0.15, 0.76))


@dataclass(frozen=True, slots=True)
class Scene:
    """All that stands around the robot. The default is the published experiment's cell."""

    fixtures: tuple[Fixture, ...] = (CONVEYOR, TARGET_TABLE)
    marks: tuple[Mark, ...] = (RED_TARGET,)
    boxes: tuple[Box, ...] = field(default_factory=lambda: (Box(),))
