"""The interface of a robot with six joints, whose calls have six values.

The vocabulary says what each joint's value means, so calls with six values and with seven are different ones.
"""

from __future__ import annotations

from collections.abc import Sequence

from .arm import Arm
from .move import Move
from .sensors import Sensors


class SixJointArm(Arm):
    """An arm with six joints."""

    def commanded_joints(self) -> tuple[float, ...]:
        """Return the setpoints of the six joints, degrees, not wrapped."""
        return self._setpoint_degrees()

    def move_joints(self, angles: Sequence[float], *, speed: float = 1.0) -> None:
        """Move all joints to `angles` (six, degrees) at once; see `Arm.move_joints`."""
        self._start_angles(angles, speed).wait()

    def start_move_joints(self, angles: Sequence[float], *, speed: float = 1.0) -> Move:
        """Start the same move as `move_joints`, and return at once."""
        return self._start_angles(angles, speed)


class SixJointSensors(Sensors):
    """The sensors of a robot with six joints."""

    def joint_angles(self) -> tuple[float, ...]:
        """Return the measured angles of the six joints, degrees, each in (-180, 180]."""
        return self._wrapped_encoders()
