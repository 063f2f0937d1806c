"""A tool as plain data: the equipment at a robot's flange.

Lengths in m, masses in kg.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import mujoco

from .effectors import Fingers, SuctionCup
from .gripping import read_gripper


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
        effector: what it takes hold with; None for a tool that holds nothing, such as a nozzle.
        file: that it was read from, for pictures: it may hold meshes that the simulation leaves out.
    """

    name: str
    spec: mujoco.MjSpec
    body: str
    point: tuple[float, float, float]
    effector: Fingers | SuctionCup | None
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
        """Return a parallel gripper from a file in MuJoCo's format, whose world frame is fixed to the flange.

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
        read = read_gripper(path, actuator, (open, closed), tuple(pads), point, force)
        return cls(Path(path).stem, read.spec, read.body, read.point, read.fingers, file=Path(path))
