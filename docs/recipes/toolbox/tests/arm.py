"""A simulated arm with a pen: it keeps what was drawn."""

import numpy as np
from planar import forward


class JointLimitError(Exception):
    """A joint would leave its range."""


class Arm:
    def __init__(self):
        self._joints = np.array([0.5, 1.0])
        self.is_down = False
        self.drawn = []

    def joints(self):
        """Return the joint angles in radians."""
        return self._joints.copy()

    def servo(self, joints):
        """Move the joints to these angles, in radians."""
        if np.any(np.abs(joints) > 2.8):
            raise JointLimitError(f"{joints} rad")
        self._joints = np.array(joints)
        if self.is_down:
            self.drawn.append(forward(self._joints))

    def pen(self, down):
        """Put the pen down or lift it."""
        self.is_down = down
