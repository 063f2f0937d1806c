"""A straight tool motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mutabot_cell.geometry import Array, rotation_about, rotation_vector

_NO_TURN = 1e-9


@dataclass(frozen=True, slots=True)
class Line:
    """A straight tool motion in the base frame: from `start` by `shift` (m), turning by `turn`.

    Attributes:
        start: position, shape (3,), m.
        rotation: orientation at the start, shape (3, 3).
        shift: shape (3,), m.
        turn: rotation vector in the tool frame, shape (3,), rad.
    """

    start: Array
    rotation: Array
    shift: Array
    turn: Array

    @classmethod
    def between(cls, start: Array, rotation: Array, end: Array, end_rotation: Array) -> Line:
        """Return the line from one tool pose to another, turning the shorter way."""
        return cls(start, rotation, end - start, rotation_vector(rotation.T @ end_rotation))

    @property
    def numbers(self) -> tuple[Array, ...]:
        """All numbers that determine the line."""
        return self.start, self.rotation, self.shift, self.turn

    @property
    def is_straight(self) -> bool:
        """Whether the tool's position follows one straight line without a turn."""
        return self.angle < _NO_TURN

    @property
    def finest(self) -> float:
        """The length of the shortest bend, m; a line has none."""
        return math.inf

    @property
    def length(self) -> float:
        """The length, m."""
        return float(np.linalg.norm(self.shift))

    @property
    def angle(self) -> float:
        """The angle of the turn, rad."""
        return float(np.linalg.norm(self.turn))

    def position_at(self, fraction: float) -> Array:
        """Return the position, shape (3,), m."""
        result: Array = self.start + fraction * self.shift
        return result

    def rotation_at(self, fraction: float) -> Array:
        """Return the rotation, shape (3, 3)."""
        result: Array = self.rotation @ rotation_about(fraction * self.turn)
        return result
