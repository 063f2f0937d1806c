"""The contents of the cell, as plain data.

Lengths in m, angles in degrees, masses in kg; world frame with z up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from os import PathLike

from .parts import Box, Part, Vector3

BASE_POSITION = (0.0, 0.0, 0.9)
"""Where the robot's base stands in the world, m."""

CAMERA = (2.2, 0.3, 2.4)
"""Where the camera stands, m: in front of the robot and above, so that the arm seldom hides what it holds."""

FRICTION_ON_SILICONE, FRICTION_ON_STEEL, FRICTION_ON_BELT, FRICTION_ON_RUBBER = 0.7, 0.4, 0.6, 1.0
"""Of dry cardboard or wood on the gripper's pads, a painted floor or frame, a conveyor's belt, a rubber mat:
typical values of tables of materials. The target table has the mat: what falls on it does not slide far."""


@dataclass(frozen=True, slots=True)
class Belt:
    """A fixture's conveyor: a drive for its surface, and an encoder. It stands still until it is run.

    Attributes:
        direction: of positive speed, in the fixture's frame; its length does not matter.
        speed_limit: of the drive, both ways, m/s.
        acceleration: with which the drive changes its speed, m/s².
        resolution: of the encoder, m of belt for one count.
        jitter: standard deviation of the speed as part of the commanded one; 0 for a drive that runs evenly.
            The speed then wanders as an Ornstein-Uhlenbeck process drawn from the round's seed.
        jitter_time: correlation time of that process, s.
    """

    direction: tuple[float, float, float] = (0.0, 1.0, 0.0)
    speed_limit: float = 0.5
    acceleration: float = 0.5
    resolution: float = 0.0001
    jitter: float = 0.0
    jitter_time: float = 0.5


@dataclass(frozen=True, slots=True)
class Fixture:
    """A block that never moves: conveyor, table, wall.

    Attributes:
        size: full edge lengths.
        angles: Euler angles x, y, z about its centre.
        friction: sliding friction coefficient of its surface against a dry part.
        belt: makes its surface move; the block itself stays where it is.
    """

    name: str
    size: tuple[float, float, float]
    centre: tuple[float, float, float]
    rgba: tuple[float, float, float, float] = (0.6, 0.6, 0.62, 1.0)
    friction: float = FRICTION_ON_STEEL
    angles: Vector3 = (0.0, 0.0, 0.0)
    belt: Belt | None = None


@dataclass(frozen=True, slots=True)
class Mark:
    """A flat coloured patch without a body. `size` is the full edge lengths in x and y."""

    name: str
    size: tuple[float, float]
    centre: tuple[float, float, float]
    rgba: tuple[float, float, float, float] = (0.8, 0.1, 0.1, 1.0)


@dataclass(frozen=True, slots=True)
class LightBarrier:
    """A lamp and a receiver opposite; interrupted by anything between them.

    Attributes:
        start, end: of the beam, world frame, m.
        rate: how often it looks, 1/s; at most once per control tick, 100.
    """

    name: str
    start: Vector3
    end: Vector3
    rate: float = 100.0


@dataclass(frozen=True, slots=True)
class DepthCamera:
    """A stereo camera that measures depth; by default Intel's RealSense D415 with its largest picture.

    Attributes:
        position: of its left imager, world frame, m.
        angles: Euler angles x, y, z of its frame: x to the right, y down, z along its axis. By default it
            looks straight down.
        columns, rows: of its imagers, pixels.
        field_of_view: across the columns, degrees.
        baseline: from the left imager to the right one along x, m.
        subpixel: standard deviation of the disparity, pixels: 0.08 is Intel's for a textured surface.
        decimation: side of a square of pixels of which a picture has the middle one.
    """

    name: str
    position: Vector3
    angles: Vector3 = (180.0, 0.0, 0.0)
    columns: int = 1280
    rows: int = 720
    field_of_view: float = 65.0
    baseline: float = 0.055
    subpixel: float = 0.08
    decimation: int = 4

    @property
    def focal_length(self) -> float:
        """The focal length, pixels."""
        return self.columns / 2 / math.tan(math.radians(self.field_of_view / 2))


CONVEYOR = Fixture(
    "conveyor", (1.0, 2.5, 0.1), (0.6, 0.0, 0.95), (0.27, 0.29, 0.31, 1.0), FRICTION_ON_BELT, belt=Belt()
)
TARGET_TABLE = Fixture(
    "target table", (0.8, 1.6, 0.06), (-0.6, 0.0, 0.73), (0.72, 0.60, 0.44, 1.0), FRICTION_ON_RUBBER
)
RED_TARGET = Mark("red target", (0.10, 0.10), (-0.4, 0.15, 0.76))


@dataclass(frozen=True, slots=True)
class Scene:
    """Everything around the robot. The default is the published experiment's cell.

    Attributes:
        camera: where the camera stands that sees parts, world frame, m.
        depth_cameras: cameras that measure depth.
    """

    fixtures: tuple[Fixture, ...] = (CONVEYOR, TARGET_TABLE)
    marks: tuple[Mark, ...] = (RED_TARGET,)
    parts: tuple[Part, ...] = field(default_factory=lambda: (Box(),))
    light_barriers: tuple[LightBarrier, ...] = ()
    camera: Vector3 = CAMERA
    depth_cameras: tuple[DepthCamera, ...] = ()

    @classmethod
    def from_mjcf(
        cls, path: str | PathLike[str], *, parts: Sequence[str] = (), fixtures: Sequence[str] = ()
    ) -> Scene:
        """Return a scene from a file in MuJoCo's format; unnamed parts are left out.

        Args:
            path: of the file.
            parts: names of bodies with one shape that collides, a box or a cylinder; they weigh what they
                weigh there.
            fixtures: names of bodies or shapes that are boxes. Their friction is the shapes'.

        Raises:
            BadModel: something is not there, or of another shape.
        """
        from .models.scene_file import read_scene  # noqa: PLC0415  # it loads MuJoCo

        found, boxes = read_scene(path, parts, fixtures)
        return cls(fixtures=tuple(Fixture(*box) for box in boxes), marks=(), parts=found)
