"""A tool motion through points on straight lines with rounded corners, without a stop."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np

from mutabot_cell.errors import BadArgument
from mutabot_cell.geometry import Array, rotation_about, rotation_vector

_SAME_PLACE = 1e-6
_NO_CORNER = 1e-4


@dataclass(frozen=True, slots=True)
class Waypoint:
    """A point of a path.

    Attributes:
        position: shape (3,), m, base frame.
        rotation: shape (3, 3).
        blend: distance from the point at which the path leaves the straight line before it and comes back to
            the one behind it, m, along an arc that touches both; 0: a sharp corner, which may only be where
            the direction does not change.
    """

    position: Array
    rotation: Array
    blend: float


@dataclass(frozen=True, slots=True)
class _Piece:
    """A straight piece from `start` along `ahead`; an arc towards `aside` if it has a `radius`."""

    start: Array
    ahead: Array
    length: float
    aside: Array | None = None
    radius: float = 0.0

    def at(self, way: float) -> Array:
        if self.aside is None:
            straight: Array = self.start + way * self.ahead
            return straight
        turned = way / self.radius
        bent: Array = self.start + self.radius * (
            math.sin(turned) * self.ahead + (1.0 - math.cos(turned)) * self.aside
        )
        return bent


class RoundedPath:
    """A tool path in the base frame, parametrised by length; the tool turns evenly between two points.

    It has what a `Line` has for the planner.

    Attributes:
        start, rotation: tool pose at the start, shape (3,), m, and (3, 3).
        length: m, with rounded corners.
        angle: rad: what the tool would turn if it turned all the way as fast, per m, as where it turns most.
        finest: length of the shortest arc, m; infinite without one.

    Raises:
        BadArgument: fewer than two points, two that follow each other in one place, or a corner that is not
            rounded.
    """

    def __init__(self, points: Sequence[Waypoint]) -> None:
        if len(points) < 2:
            raise BadArgument("Expected a path of at least one point but got none")
        places = [point.position for point in points]
        steps = [float(np.linalg.norm(end - begin)) for begin, end in pairwise(places)]
        if min(steps) < _SAME_PLACE:
            number = min(range(len(steps)), key=steps.__getitem__) + 1
            raise BadArgument(
                f"Expected another place than the one before but got the same at point {number}"
            )
        self.start, self.rotation = places[0], points[0].rotation
        self._points = points
        self._pieces, marks = _pieces(points, steps)
        self._ends = list(accumulate(piece.length for piece in self._pieces))
        self.length = self._ends[-1]
        self._marks = [0.0, *marks, self.length]
        self._turns = [rotation_vector(a.rotation.T @ b.rotation) for a, b in pairwise(points)]
        rates = (
            float(np.linalg.norm(turn)) / (end - begin)
            for turn, (begin, end) in zip(self._turns, pairwise(self._marks), strict=True)
        )
        self.angle = max(rates) * self.length
        self.finest = min((piece.length for piece in self._pieces if piece.radius), default=math.inf)

    @property
    def numbers(self) -> tuple[Array, ...]:
        """All numbers that determine the path."""
        return tuple(
            part for point in self._points for part in (point.position, point.rotation, np.array(point.blend))
        )

    @property
    def is_straight(self) -> bool:
        """Whether the tool's position follows one straight line without a turn."""
        return False

    def position_at(self, fraction: float) -> Array:
        """Return the position, shape (3,), m."""
        way = min(max(fraction, 0.0), 1.0) * self.length
        index = min(bisect_right(self._ends, way), len(self._pieces) - 1)
        return self._pieces[index].at(way - (self._ends[index - 1] if index else 0.0))

    def rotation_at(self, fraction: float) -> Array:
        """Return the rotation, shape (3, 3)."""
        way = min(max(fraction, 0.0), 1.0) * self.length
        index = min(bisect_right(self._marks, way) - 1, len(self._turns) - 1)
        begin, end = self._marks[index], self._marks[index + 1]
        part = (way - begin) / (end - begin)
        result: Array = self._points[index].rotation @ rotation_about(part * self._turns[index])
        return result


def _pieces(points: Sequence[Waypoint], steps: Sequence[float]) -> tuple[list[_Piece], list[float]]:
    """Return the pieces of a path, and the lengths at which it passes each point but the first and last."""
    pieces: list[_Piece] = []
    marks: list[float] = []
    place, gone = points[0].position, 0.0
    for index, (point, step) in enumerate(zip(points[1:], steps, strict=True), start=1):
        ahead = (point.position - points[index - 1].position) / step
        if index == len(points) - 1:
            rest = float(np.linalg.norm(point.position - place))
            pieces.append(_Piece(place, ahead, rest))
            break
        behind = (points[index + 1].position - point.position) / steps[index]
        corner = math.atan2(float(np.linalg.norm(np.cross(ahead, behind))), float(ahead @ behind))
        blend = min(point.blend, step / 2, steps[index] / 2) if corner > _NO_CORNER else 0.0
        if corner > _NO_CORNER and blend <= 0.0:
            raise BadArgument(
                f"Expected a blend above 0 where the path turns by {math.degrees(corner):.0f} deg but got "
                f"blend={point.blend!r} at point {index}: to stop there, end the path"
            )
        rest = float(np.linalg.norm(point.position - place)) - blend
        if rest > 0.0:
            pieces.append(_Piece(place, ahead, rest))
            gone += rest
        place = point.position - blend * ahead
        if blend:
            radius = blend / math.tan(corner / 2)
            aside = behind - float(behind @ ahead) * ahead
            arc = _Piece(place, ahead, radius * corner, aside / np.linalg.norm(aside), radius)
            pieces.append(arc)
            marks.append(gone + arc.length / 2)
            gone += arc.length
            place = point.position + blend * behind
        else:
            marks.append(gone)
    return pieces, marks
