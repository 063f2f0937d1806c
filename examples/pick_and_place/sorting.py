"""Take a box from the conveyor, wherever it lies, and set it down on the table at the place of its colour."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from mutabot_cell import Cell, Pose, Position, SensorError

OPEN = 0
CLOSED = 1
GENTLE, FIRM = 40, 160
"""Grip forces, N: the second for what slips out of the first."""

BASE_HEIGHT = 0.9
"""Where the robot's base stands above the floor, m: the camera measures from the floor, the arm from here."""
CONVEYOR_TOP = 1.0
TABLE_TOP = 0.76
PLACES = {"red": (-0.40, 0.15), "blue": (-0.40, 0.40)}
"""Where boxes belong on the table (x, y), m."""

EDGE = 0.05
"""Of a box, m."""
APPROACH = 0.15
"""How far above a box, or above its place, the gripper waits, m."""
CLEARANCE = 0.0015
"""Left below a box when it is let go, m: three standard deviations of the camera."""
TRIAL_LIFT = 0.02
"""How far a box is lifted to see whether it comes along, m."""
GRIP_HEIGHT = 0.03
"""Where the fingers hold the box, above its bottom, m."""
PALM = 0.035
"""From the gripper's palm, where the distance sensor sits, to between the fingers, m."""
OVER_CONVEYOR = (0, 26, 180, -78, 0, -76, 90)
OVER_TABLE = (-145, 26, 180, -78, 0, -76, 90)
"""Joint angles, degrees: the gripper looks down, 0.2 m above the conveyor, 0.44 m above the table."""
DOWN = (180, 0, 90)
DOWN_TO_THE_BACK = (180, 0, -90)
"""Orientations with the gripper looking down, degrees."""


class Outcome(Enum):
    """How it ended."""

    PLACED = "placed"
    NO_BOX = "no box"
    SLIPPED = "slipped at the conveyor"
    LOST = "lost on the way"


@dataclass(frozen=True)
class Report:
    """What the robot tells its operator.

    Attributes:
        outcome: how it ended; the robot is at home with an open gripper in every case.
        colour: of the box; None if there was none to look at.
        grips: how often the gripper closed.
    """

    outcome: Outcome
    colour: str | None = None
    grips: int = 0


class NoBoxError(Exception):
    """The conveyor is empty, or camera and distance sensor disagree about what lies there."""


def run(cell: Cell) -> Report:
    """Sort one box. The robot may start anywhere; it ends at home, the gripper open."""
    cell.gripper.command(OPEN)
    report = sort(cell)
    cell.arm.home()
    return report


def sort(cell: Cell) -> Report:
    """Pick the box and place it, as far as that goes."""
    try:
        colour, grips, held = pick(cell)
    except NoBoxError:
        return Report(Outcome.NO_BOX)
    if not held:
        return Report(Outcome.SLIPPED, colour, grips)
    placed = place(cell, colour)
    return Report(Outcome.PLACED if placed else Outcome.LOST, colour, grips)


def pick(cell: Cell) -> tuple[str, int, bool]:
    """Pick the box up; try once more, firmer, if it slips.

    Returns its colour, how often the gripper closed, and whether the gripper holds the box.

    Raises NoBoxError: there is none.
    """
    find(cell)
    cell.arm.move_joints(OVER_CONVEYOR)
    for grips, force in enumerate((GENTLE, FIRM), start=1):
        colour, held = grip(cell, force)
        if held:
            return colour, grips, True
    return colour, grips, False


def grip(cell: Cell, force: float) -> tuple[str, bool]:
    """Grip the box where it lies, and lift it if it comes along; else let it go. The gripper ends high above.

    Returns the box's colour, and whether it came along.

    Args:
        force: at each finger, N.

    Raises NoBoxError: there is none.
    """
    box = find(cell)
    cell.arm.move_to(Pose(box.x, box.y, box.z - BASE_HEIGHT + GRIP_HEIGHT + APPROACH, *DOWN))
    feel(cell)
    colour = cell.sensors.colour()
    cell.arm.move_by(z=-APPROACH)
    cell.gripper.set_force(force)
    cell.gripper.command(CLOSED)
    cell.wait(0.8)
    cell.arm.move_by(z=TRIAL_LIFT)
    lifted = Position(box.x, box.y, box.z + TRIAL_LIFT)
    held = holds_box(cell) and is_near(cell.sensors.box_position(), lifted)
    if not held:
        cell.gripper.command(OPEN)
        cell.wait(0.8)
    cell.arm.move_by(z=APPROACH - TRIAL_LIFT)
    return colour, held


def find(cell: Cell) -> Position:
    """Where the camera sees the box; world frame, m.

    Raises NoBoxError: it sees none, or none that lies on the conveyor.
    """
    try:
        box = cell.sensors.box_position()
    except SensorError as error:
        raise NoBoxError from error
    if abs(box.z - CONVEYOR_TOP) > 0.01:
        raise NoBoxError
    return box


def feel(cell: Cell) -> None:
    """Ask the distance sensor in the palm whether the top of a box lies below.

    Raises NoBoxError: it does not.
    """
    expected = PALM + APPROACH + GRIP_HEIGHT - EDGE
    if abs(cell.sensors.distance() - expected) > 0.01:
        raise NoBoxError


def holds_box(cell: Cell) -> bool:
    """Whether the fingers press on something as wide as a box."""
    return cell.gripper.holding() and abs(cell.gripper.opening() - EDGE) < 0.003


def is_near(seen: Position, expected: Position) -> bool:
    """Whether the camera sees the box where the arm should have taken it."""
    return math.dist((seen.x, seen.y, seen.z), (expected.x, expected.y, expected.z)) < 0.01


def place(cell: Cell, colour: str) -> bool:
    """Carry the box over and set it down; False if it got lost on the way."""
    cell.arm.move_joints(OVER_TABLE)
    x, y = PLACES[colour]
    tool_height = TABLE_TOP + APPROACH + GRIP_HEIGHT - BASE_HEIGHT
    cell.arm.move_to(Pose(x, y, tool_height, *DOWN_TO_THE_BACK))
    try:
        box = cell.sensors.box_position()
    except SensorError:  # the camera does not see it
        box = None
    if box is None or not (holds_box(cell) and is_near(box, Position(x, y, TABLE_TOP + APPROACH))):
        cell.gripper.command(OPEN)
        return False
    cell.arm.move_by(x=x - box.x)  # the fingers have centred the box in y, not in x
    cell.arm.move_by(z=TABLE_TOP + CLEARANCE - box.z)
    cell.gripper.command(OPEN)
    cell.wait(0.8)
    cell.arm.move_by(z=APPROACH)
    return True
