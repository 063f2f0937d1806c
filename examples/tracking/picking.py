"""Pick boxes from the moving belt in the order in which they come; set each down in the row of its colour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from mutabot_cell import Cell, Pose, Position, SensorError

OPEN = 0
CLOSED = 1
SPEED = 0.08
"""Of the belt, m/s."""

BASE_HEIGHT = 0.9
"""Where the robot's base stands above the floor, m: the camera measures from the floor, the arm from here."""
BELT_TOP = 1.0
TABLE_TOP = 0.76
ROWS = {"red": 0.15, "blue": 0.40}
"""Where the row of each colour lies on the table (y), m."""
FIRST_IN_ROW, ROW_STEP = -0.35, -0.12
"""Where a row begins (x), and how far apart its boxes stand, m."""
LEAST_X, MOST_X = 0.38, 0.6
"""Across the belt the gripper reaches boxes from here to there, m."""
START = -0.25
"""A box is picked from here on (y), m."""
CYCLE = 9.0
"""What setting a box down and coming back takes, s, rounded up: so long the belt runs on by itself."""
LATEST = 0.0
"""A box that would get past this meanwhile must wait: the belt stops (y), m."""
LONGEST_WAIT = 20
"""What a box takes to come from the belt's beginning, s, rounded up."""

EDGE = 0.05
"""Of a box, m."""
APPROACH = 0.12
"""How far above a box, or above its place, the gripper waits, m."""
CLEARANCE = 0.0015
"""Left below a box when it is let go, m: three standard deviations of the camera."""
GRIP_HEIGHT = 0.03
"""Where the fingers hold the box, above its bottom, m."""
PALM = 0.035
"""From the gripper's palm, where the distance sensor sits, to between the fingers, m."""
OVER_BELT = (12, 26, 180, -78, 0, -76, 90)
OVER_TABLE = (-145, 26, 180, -78, 0, -76, 90)
"""Joint angles, degrees: the gripper looks down, 0.2 m above the belt, 0.44 m above the table."""
DOWN = (180, 0, 90)
DOWN_TO_THE_BACK = (180, 0, -90)
"""Orientations with the gripper looking down, degrees."""


@dataclass(frozen=True)
class Report:
    """What the robot tells its operator. At the end the belt stands, the robot is at home, its gripper open.

    Attributes:
        placed: colours of the boxes that were set down, in order.
        left: names of the boxes that came and were not, in order.
    """

    placed: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)


def run(cell: Cell, names: Sequence[str]) -> Report:
    """Sort the boxes of a batch until none that was not tried is seen on the belt.

    Args:
        names: of the batch's boxes, as the camera knows them.
    """
    report = Report()
    cell.gripper.command(OPEN)
    cell.arm.move_joints(OVER_BELT)
    waiting = list(names)
    while (name := next_box(cell, waiting)) is not None:
        waiting.remove(name)
        colour = pick(cell, name) if await_box(cell, name) else None
        stop_for(cell, next_box(cell, waiting))
        if colour is not None and place(cell, name, colour, report.placed.count(colour)):
            report.placed.append(colour)
        else:
            report.left.append(name)
        cell.arm.move_joints(OVER_BELT)
    cell.belt().stop()
    cell.arm.home()
    return report


def next_box(cell: Cell, names: Sequence[str]) -> str | None:
    """The foremost of these boxes that the camera sees on the belt, in reach across it."""
    seen = {name: box for name in names if (box := find(cell, name)) is not None}
    return max(seen, key=lambda name: seen[name].y, default=None)


def find(cell: Cell, name: str) -> Position | None:
    """Where the camera sees a box on the belt, in reach across it; world frame, m. None if it does not."""
    try:
        box = cell.sensors.box_position(name)
    except SensorError:
        return None
    on_belt = abs(box.z - BELT_TOP) < 0.01 and LEAST_X < box.x < MOST_X
    return box if on_belt else None


def await_box(cell: Cell, name: str) -> bool:
    """Let the belt bring the box to where it can be picked; False if it does not come."""
    for _ in range(LONGEST_WAIT * 10):
        box = find(cell, name)
        if box is None:
            return False
        if box.y >= START:
            return True
        cell.belt().run(SPEED)
        cell.wait(0.1)
    return False


def stop_for(cell: Cell, name: str | None) -> None:
    """Stop the belt if this box would otherwise get past before the gripper is back."""
    box = None if name is None else find(cell, name)
    if box is not None and box.y + SPEED * CYCLE > LATEST:
        cell.belt().stop()


def pick(cell: Cell, name: str) -> str | None:
    """Grip a box on the belt, which runs or stands, and lift it.

    Returns its colour; None if the gripper does not hold it. The gripper ends above the belt, at rest.
    """
    box, belt = find(cell, name), cell.belt()
    if box is None:
        return None
    cell.arm.track(belt, belt.position(cell.sensors.picture_time()))
    cell.arm.move_to(Pose(box.x, box.y, box.z - BASE_HEIGHT + GRIP_HEIGHT + APPROACH, *DOWN))
    colour = None
    if feels_box(cell):
        colour = cell.sensors.colour(name)
        cell.arm.move_by(z=-APPROACH)
        cell.gripper.command(CLOSED)
        cell.wait(0.8)
        cell.arm.move_by(z=APPROACH)
    cell.arm.stop_tracking()
    if not holds_box(cell):
        cell.gripper.command(OPEN)
        return None
    return colour


def feels_box(cell: Cell) -> bool:
    """Whether the distance sensor in the palm measures the top of a box below the gripper."""
    expected = PALM + APPROACH + GRIP_HEIGHT - EDGE
    return abs(cell.sensors.distance() - expected) < 0.01


def holds_box(cell: Cell) -> bool:
    """Whether the fingers press on something as wide as a box."""
    return cell.gripper.holding() and abs(cell.gripper.opening() - EDGE) < 0.003


def place(cell: Cell, name: str, colour: str, before: int) -> bool:
    """Carry the box over, set it down behind so many others in its row; False if it got lost on the way."""
    cell.arm.move_joints(OVER_TABLE)
    x, y = FIRST_IN_ROW + before * ROW_STEP, ROWS[colour]
    height = TABLE_TOP + APPROACH
    cell.arm.move_to(Pose(x, y, height + GRIP_HEIGHT - BASE_HEIGHT, *DOWN_TO_THE_BACK))
    cell.wait(0.1)  # until the camera's picture shows the arm at rest
    try:
        box = cell.sensors.box_position(name)
    except SensorError:  # the camera does not see it
        box = None
    is_there = box is not None and math.dist((box.x, box.y, box.z), (x, y, height)) < 0.01
    if box is not None and is_there and holds_box(cell):
        cell.arm.move_by(x=x - box.x)  # the fingers have centred the box in y, not in x
        cell.arm.move_by(z=TABLE_TOP + CLEARANCE - box.z)
        cell.gripper.command(OPEN)
        cell.wait(0.8)
        cell.arm.move_by(z=APPROACH)
    cell.gripper.command(OPEN)
    cell.arm.move_joints(OVER_TABLE)
    return is_there
