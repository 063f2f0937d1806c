"""A tool path as a robot program describes it: point by point, then travelled without a stop."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from mutabot_cell.motion.rounded_path import RoundedPath, Waypoint

from .errors import BadArgument, MotionRefused
from .geometry import Array, Pose, rotation_from_euler
from .move import Move

_LOOK_AHEAD, _FINE = 0.02, 0.0005
"""How far ahead of where the tool may be by now it is looked for, and in which steps, m."""


class ToolPath:
    """A path through poses, with rounded corners, that begins at the commanded tool pose.

        path = cell.arm.new_path()
        path.line_to(Pose(0.5, 0.1, 0.1, 180, 0, 90), blend=0.01)
        path.line_to(Pose(0.5, -0.1, 0.1, 180, 0, 90))
        move = path.start(speed=0.05)

    Args:
        begin: gives tool position (shape (3,), m) and rotation (shape (3, 3)) at the start, base frame.
        where: gives the tool's position by the encoders, shape (3,), m, base frame.
        start: carries out a path at a speed, m/s.
        clock: gives the simulated time, s.
    """

    def __init__(
        self,
        begin: Callable[[], tuple[Array, Array]],
        where: Callable[[], Array],
        start: Callable[[RoundedPath, float], Move],
        clock: Callable[[], float],
    ) -> None:
        self._begin, self._where, self._start, self._clock = begin, where, start, clock
        self._points: list[Waypoint] = []
        self._path: RoundedPath | None = None
        self._speed = self._gone = self._looked = 0.0

    def line_to(self, pose: Pose, *, blend: float = 0.0) -> None:
        """Add a straight line to a pose, during which the tool turns evenly.

        Args:
            pose: base frame, m and degrees.
            blend: how far from the pose the corner there begins to be rounded, m; at most half of either
                line. Only a pose where the path ends or goes straight on needs none.

        Raises:
            BadArgument: a value is not a finite number, or the path has begun.
        """
        values = (pose.x, pose.y, pose.z, pose.theta_x, pose.theta_y, pose.theta_z, blend)
        if not all(isinstance(value, int | float | np.floating) and math.isfinite(value) for value in values):
            raise BadArgument(f"Expected 7 finite numbers but got pose={pose!r}, blend={blend!r}")
        if blend < 0.0:
            raise BadArgument(f"Expected blend >= 0 but got blend={blend!r}")
        if self._path is not None:
            raise BadArgument("Expected a path that has not begun but got one that was started")
        self._points.append(Waypoint(np.array(values[:3]), rotation_from_euler(*values[3:6]), blend))

    def start(self, speed: float) -> Move:
        """Begin to travel the path; return at once. Joint limits can make the motion slower.

        Args:
            speed: of the tool along the path, m/s.

        Raises:
            BadArgument: no point, a sharp corner, a speed out of its range, or the path has begun.
            MotionRefused: some point of the path is out of reach or limits; nothing has moved.
        """
        if self._path is not None:
            raise MotionRefused("the path was travelled already", limit="path")
        path = RoundedPath([Waypoint(*self._begin(), 0.0), *self._points])
        move = self._start(path, speed)
        self._path, self._speed, self._looked = path, speed, self._clock()
        return move

    def length(self) -> float:
        """Return the length of the whole path, with rounded corners, m; 0 before it begins."""
        return 0.0 if self._path is None else self._path.length

    def travelled(self) -> float:
        """Return how far along the path the tool has come, by the encoders, m; it never decreases."""
        if self._path is None:
            return 0.0
        place, length, now = self._where(), self._path.length, self._clock()
        farthest = min(self._gone + self._speed * (now - self._looked) + _LOOK_AHEAD, length)
        self._looked = now
        ways = np.arange(self._gone, farthest + _FINE / 2, _FINE).tolist()
        distances = [math.dist(self._path.position_at(way / length), place) for way in ways]
        self._gone = min(ways[int(np.argmin(distances))], length)
        return self._gone
