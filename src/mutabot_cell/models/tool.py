"""A tool as plain data: what is fastened to a robot's flange, and what it takes hold with.

Lengths in m, forces in N, masses in kg.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path

import mujoco

from .vacuum import Ejector

LIP_FRICTION = 0.5
"""Of a rubber lip on dry glass, metal or plastic: what makers of cups reckon with."""
SEALED_GAP, SENSED_GAP = 0.0002, 0.0007
"""How far a surface may be away until a flexible lip no longer follows it, and until a point of the lip does
not narrow the opening any more, m (our choice)."""


@dataclass(frozen=True, slots=True)
class Fingers:
    """A parallel gripper's fingers.

    Attributes:
        actuator: name of the position servo that moves them.
        pads: names of the shapes that touch what is gripped.
        stroke: how far the opening changes from open to closed, m.
        paths: how far the fingers have closed at some points of their way, from 0 to the stroke, m.
        controls, lengths: input of the servo, and what it measures, there; in its own units.
        force_range: grip force at each pad, N.
        speed_range: how fast the opening changes, m/s.
        force, speed: of a cell that does not say otherwise.
        force_ratio: force of the servo, in its own unit, for 1 N at each pad.
    """

    actuator: str
    pads: tuple[str, ...]
    stroke: float
    paths: tuple[float, ...]
    controls: tuple[float, ...]
    lengths: tuple[float, ...]
    force_range: tuple[float, float]
    speed_range: tuple[float, float]
    force: float
    speed: float
    force_ratio: float = 1.0


@dataclass(frozen=True, slots=True)
class SuctionCup:
    """A suction cup, its vacuum and the sensor for that.

    Makers state the holding force as vacuum times area, at 60 kPa and without a safety factor (Schmalz's
    glossary): 42 N for 30 mm.

    Attributes:
        body: name of the body that carries the lip; its z axis points out of the cup, its origin is in the
            plane of the lip.
        lip: names of shapes along the lip, evenly spaced on a circle of the cup's diameter.
        diameter: of the lip, m.
        friction: of the lip on a dry part.
        leak: opening that a worn lip or a porous part leaves when the cup seals, m².
        ejector: what makes the vacuum.
    """

    body: str
    lip: tuple[str, ...]
    diameter: float
    friction: float = LIP_FRICTION
    leak: float = 0.0
    ejector: Ejector = field(default_factory=Ejector)

    @property
    def area(self) -> float:
        """On which the vacuum acts, m²."""
        return math.pi * self.diameter**2 / 4


@dataclass(frozen=True, slots=True, eq=False)
class Tool:
    """A tool.

    Attributes:
        name: of the tool's type.
        spec: the tool alone; its world frame is fastened to the flange.
        body: name of the body that is fastened to the flange.
        point: the tool point in the flange's frame, m: where the tool takes hold.
        turn: orientation of the tool's frame in the flange's frame, a unit quaternion (w, x, y, z).
        palm: of a distance sensor on the tool's axis, seen from the tool point, m; negative behind it.
        effector: what it takes hold with.
        file: that it was read from, for pictures: it may hold meshes that the simulation leaves out.
    """

    name: str
    spec: mujoco.MjSpec
    body: str
    point: tuple[float, float, float]
    effector: Fingers | SuctionCup
    turn: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    palm: float = 0.0
    file: Path | None = None

    @classmethod
    def from_mjcf(
        cls,
        path: str | PathLike[str],
        *,
        actuator: str,
        open: float,  # as users call it
        closed: float,
        pads: Sequence[str],
        point: str | None = None,
        force: float | None = None,
    ) -> Tool:
        """A parallel gripper from a file in MuJoCo's format, whose world frame is fastened to the flange.

        What it can do is measured once: the fingers are opened and closed without gravity.

        Args:
            path: of the file.
            actuator: name of the servo that moves the fingers.
            open, closed: its inputs for open and for closed fingers.
            pads: names of the shapes that touch what is gripped, on both sides.
            point: name of the site that is the tool point; by default the middle of the closed pads.
            force: grip force at each pad of a cell that does not say otherwise, N; the largest by default.

        Raises:
            BadModel: the file lacks something; the message says what to add.
            BadArgument: an argument does not fit it.
        """
        from .gripping import gripper_from_mjcf  # noqa: PLC0415  # which knows this module

        return gripper_from_mjcf(path, actuator, (open, closed), tuple(pads), point, force)
