"""A tool as plain data: what is fastened to a robot's flange, and what it takes hold with.

Lengths in m, forces in N, masses in kg.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco


@dataclass(frozen=True, slots=True)
class Fingers:
    """A parallel gripper's fingers.

    Attributes:
        actuator: name of the position servo that moves them.
        pads: names of the shapes that touch what is gripped.
        stroke: how far the opening changes from open to closed, m.
        controls: input of the servo for open and for closed fingers.
        lengths: what the servo measures of open and of closed fingers, in its own unit.
        force_range: grip force at each pad, N.
        speed_range: how fast the opening changes, m/s.
        force_ratio: force of the servo, in its own unit, for 1 N at each pad.
    """

    actuator: str
    pads: tuple[str, ...]
    stroke: float
    controls: tuple[float, float]
    lengths: tuple[float, float]
    force_range: tuple[float, float]
    speed_range: tuple[float, float]
    force_ratio: float = 1.0


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
    """

    name: str
    spec: mujoco.MjSpec
    body: str
    point: tuple[float, float, float]
    effector: Fingers
    turn: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    palm: float = 0.0
