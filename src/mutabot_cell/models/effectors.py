"""The gripping part of a tool, as plain data: fingers or a suction cup.

Lengths in m, forces in N.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

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
    """A suction cup, its vacuum and its vacuum sensor.

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
        """The area on which the vacuum acts, m²."""
        return math.pi * self.diameter**2 / 4
