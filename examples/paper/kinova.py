"""The robot's application interface, as thin as the maker's: what `mission.py` is written against.

In this example a simulated cell stands behind it. `connect` must be called before the first command.
"""

from __future__ import annotations

from mutabot_cell import Cell, Pose

_cell: Cell | None = None


def connect(cell: Cell) -> None:
    """Let all commands and readings go to this cell."""
    global _cell  # noqa: PLW0603  (one robot per process, as with the maker's driver)
    _cell = cell


def _connected() -> Cell:
    if _cell is None:
        raise RuntimeError("no robot: call kinova.connect(cell) first")
    return _cell


class Arm:
    """The arm. Lengths in m, angles in degrees, all in the base frame."""

    def home(self) -> None:
        """Joint move to the home position."""
        _connected().arm.home()

    def move_by(
        self,
        x: float = 0.0,
        y: float = 0.0,
        z: float = 0.0,
        theta_x: float = 0.0,
        theta_y: float = 0.0,
        theta_z: float = 0.0,
    ) -> None:
        """Straight-line move of the tool, relative to where it was last sent."""
        _connected().arm.move_by(x, y, z, theta_x, theta_y, theta_z)

    def tool_pose(self) -> Pose:
        """Where the tool was last sent."""
        return _connected().arm.commanded_pose()


class Gripper:
    """The gripper."""

    def command(self, position: float) -> None:
        """Start moving the fingers: 0 is open, 1 is closed. Returns at once."""
        _connected().gripper.command(position)

    def position(self) -> float:
        """The last command."""
        return _connected().gripper.commanded()


class ColorSensor:
    """The sensor that looks at the box on the conveyor."""

    def read(self) -> int:
        """A whole number from 1 to 10: even means the red box, odd the blue one."""
        return _connected().sensors.colour_number()


def wait(seconds: float) -> None:
    """Wait."""
    _connected().wait(seconds)
