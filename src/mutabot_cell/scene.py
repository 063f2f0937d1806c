"""What stands in the cell, as plain data.

Lengths in m, angles in degrees, masses in kg; world frame with z up.
"""

from __future__ import annotations

from dataclasses import dataclass, field

BASE_POSITION = (0.0, 0.0, 0.9)
"""Where the robot's base stands in the world, m."""

CAMERA = (2.2, 0.3, 2.4)
"""Where the camera stands, m: in front of the robot and above, so that the arm seldom hides what it holds."""

BOX_EDGE = 0.05
FRICTION_ON_SILICONE, FRICTION_ON_STEEL, FRICTION_ON_BELT, FRICTION_ON_RUBBER = 0.7, 0.4, 0.6, 1.0
"""Of dry cardboard or wood on the gripper's pads, a painted floor or frame, a conveyor's belt, a rubber mat:
typical values of tables of materials. The target table has the mat: what falls on it does not slide far."""
RED_RGBA = (0.78, 0.13, 0.12, 1.0)
BLUE_RGBA = (0.13, 0.30, 0.75, 1.0)


@dataclass(frozen=True, slots=True)
class Fixture:
    """A block that never moves: conveyor, table, wall.

    Attributes:
        size: full edge lengths.
        friction: sliding friction coefficient of its surface against a dry box.
    """

    name: str
    size: tuple[float, float, float]
    centre: tuple[float, float, float]
    rgba: tuple[float, float, float, float] = (0.6, 0.6, 0.62, 1.0)
    friction: float = FRICTION_ON_STEEL


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
        friction: sliding friction coefficient of every contact of this box, for one that is oily or wet; None
            for a dry box of cardboard or wood, whose coefficients are those of what it touches.
    """

    name: str = "box"
    position: tuple[float, float, float] = (0.55, 0.2, 1.0)
    yaw: float = 0.0
    colour: str | None = None
    edge: float = BOX_EDGE
    mass: float = 0.1
    friction: float | None = None
    jitter: float = 0.0005


CONVEYOR = Fixture("conveyor", (1.0, 2.5, 0.1), (0.6, 0.0, 0.95), (0.27, 0.29, 0.31, 1.0), FRICTION_ON_BELT)
TARGET_TABLE = Fixture(
    "target table", (0.8, 1.6, 0.06), (-0.6, 0.0, 0.73), (0.72, 0.60, 0.44, 1.0), FRICTION_ON_RUBBER
)
RED_TARGET = Mark("red target", (0.10, 0.10), (-0.4, 0.15, 0.76))


@dataclass(frozen=True, slots=True)
class Scene:
    """All that stands around the robot. The default is the published experiment's cell.

    Attributes:
        camera: where the camera stands that sees boxes, world frame, m.
    """

    fixtures: tuple[Fixture, ...] = (CONVEYOR, TARGET_TABLE)
    marks: tuple[Mark, ...] = (RED_TARGET,)
    boxes: tuple[Box, ...] = field(default_factory=lambda: (Box(),))
    camera: tuple[float, float, float] = CAMERA
