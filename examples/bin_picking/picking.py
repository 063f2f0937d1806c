"""Empty a bin of mixed parts: look, grasp a face, put the part into the tray of its shape, and so on."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import vision
from station import BIN, STAND, STAND_TOP, TRAY_TOP, TRAYS
from vision import Face

from mutabot_cell import Cell, MotionRefused, Pose
from mutabot_cell.depth_camera import DepthPicture
from mutabot_cell.geometry import Array, euler_from_rotation, rotation_about, rotation_from_euler

BASE_HEIGHT, TABLE = 0.9, 0.1
"""Of the robot's base above the floor, from where the camera measures, and of the table above the base, m."""
DOWN = (180.0, 0.0, 90.0)
"""Orientation of a cup that looks straight down, degrees."""
OVER_BIN, ASIDE = (0, 15, 180, -95, 0, -70, 90), (60, 15, 180, -95, 0, -70, 90)
"""Joint angles, degrees: the cup looks down above the bin; and beside it, out of the camera's sight."""
HIGH = 0.25
"""At this height of the cup no part that it holds touches anything, m."""
COLUMNS, ROWS, ACROSS, ALONG = 2, 3, 0.09, 0.075
"""Of the places in a tray: how many, and how far apart, m."""
PRESS = (0.004, 0.008)
"""By so much the cup is pressed on a face, and then on one that gives way, m: the plunger yields."""
APPROACH, TRIAL_LIFT = 0.06, 0.05
"""From so far the cup comes along a face's normal; after so much lifting the part must still be there, m."""
VACUUM_WITHIN, VENTED_WITHIN, VENTED = 0.6, 1.0, 5e3
"""So long vacuum may take to come and to go, s; and below what nothing is held, Pa."""
LONGEST, SEARCH, TOUCH, SPEED = 0.065, 0.055, 5.0, 0.05
"""A part hangs down by at most so much; it is lowered by so much, m, until it resists so hard, N, with this
speed, m/s."""
YIELD, THICKNESS_WITHIN = 0.004, 0.002
"""By so much the plunger yields until the part resists; and how well a part's thickness must be right, m."""
MOST_FAILURES, MOST_PRESSES, MOST_RETURNS = 3, 2, 2
"""So many grasps may fail until the robot presses on the heap, so often it does that in a row,
and so many parts go back into the bin."""
PRESSING, PRESSED_BY, PRESSED_FROM = 9.0, 0.06, 0.02
"""Force of that, N: the plunger yields to it; how far it goes at most, and from where above the heap, m."""


@dataclass
class Report:
    """What came of it. At the end the robot is at home, the ejector off.

    Attributes:
        result: "empty", "nothing graspable", "part lost" or "not recognised".
        placed: how many parts are in the tray of each shape.
        failed: how many grasps got no vacuum, or lost it while the part was lifted.
        regrasped: how many parts were put on the stand and taken again.
        returned: how many of these were put back into the bin.
    """

    result: str = ""
    placed: dict[str, int] = field(default_factory=lambda: dict.fromkeys(TRAYS, 0))
    failed: int = 0
    regrasped: int = 0
    returned: int = 0


def run(cell: Cell) -> Report:
    """Empty the bin."""
    report = Report()
    cell.suction.off()
    avoided: list[tuple[float, float]] = []
    presses = 0
    while not report.result:
        picture = look(cell)
        face = vision.locate_on_stand(picture) or vision.locate(picture, avoided)
        nothing_in_bin = vision.is_empty(picture)
        if face is None and nothing_in_bin:
            report.result = "empty"
        elif (face is None or len(avoided) == MOST_FAILURES) and (presses == MOST_PRESSES or nothing_in_bin):
            report.result = "nothing graspable"
        elif face is None or len(avoided) == MOST_FAILURES:
            press(cell, *vision.highest(picture))
            avoided.clear()
            presses += 1
        elif grasp(cell, face):
            avoided.clear()
            presses = 0
            report.result = sort(cell, face, report)
        else:
            avoided.append((face.x, face.y))
            report.failed += 1
    cell.suction.off()
    cell.arm.home()
    return report


def look(cell: Cell) -> DepthPicture:
    """Take a picture while the arm is out of its way."""
    cell.arm.move_joints(ASIDE)
    return cell.depth_camera().picture()


def grasp(cell: Cell, face: Face) -> bool:
    """Press the cup on a face and lift the part; whether it comes along. Without it the cup is high above."""
    place, axis = np.array([face.x, face.y, face.z - BASE_HEIGHT]), face.normal
    turn = orientation(axis)
    above = place + APPROACH * axis
    way = Pose(above[0], above[1], HIGH, *DOWN), Pose(*above.tolist(), *turn)
    held = False
    cell.arm.move_joints(OVER_BIN)
    cell.suction.on()
    try:
        for pose in way:
            cell.arm.move_to(pose)
        for depth in PRESS:
            cell.arm.move_to(Pose(*(place - depth * axis).tolist(), *turn))
            held = wait_until(cell, cell.suction.holding, VACUUM_WITHIN)
            if held:
                break
        if held:
            cell.arm.move_by(z=TRIAL_LIFT)
            held = cell.suction.holding()
    except MotionRefused:
        held = False
    if not held:
        cell.suction.off()
    try:
        cell.arm.move_by(z=HIGH - cell.arm.commanded_pose().z)
    except MotionRefused:  # so tilted it does not get up there: back the way that it came
        for pose in reversed(way):
            cell.arm.move_to(pose)
    return held and cell.suction.holding()


def press(cell: Cell, x: float, y: float, z: float) -> None:
    """Press on a part that leans on others or on a wall, so that it slips and lies flat. World frame, m."""
    cell.arm.move_joints(OVER_BIN)
    cell.arm.move_to(Pose(x, y, HIGH, *DOWN))
    cell.force_sensor.zero()
    cell.arm.move_to(Pose(x, y, z - BASE_HEIGHT + PRESSED_FROM, *DOWN))
    cell.arm.move_until_contact(z=-PRESSED_BY, force=PRESSING, speed=SPEED)
    cell.arm.move_by(z=HIGH - cell.arm.commanded_pose().z)


def orientation(axis: Array) -> tuple[float, float, float]:
    """The orientation, degrees, of a cup that looks against a unit vector, shape (3,), and is not turned."""
    tilt = math.acos(min(1.0, axis[2]))
    about = np.array([-axis[1], axis[0], 0.0])
    turned = rotation_about(about / max(np.linalg.norm(about), 1e-9) * tilt)
    return euler_from_rotation(turned @ rotation_from_euler(*DOWN))


def sort(cell: Cell, face: Face, report: Report) -> str:
    """Carry the part that the cup holds into its tray; by way of the stand if it was not recognised.

    Returns:
        Why the robot cannot go on; empty if it can.
    """
    for is_last in (False, True):
        if report.placed.get(face.shape, COLUMNS * ROWS) < COLUMNS * ROWS:
            thickness = lower(cell, *slot(face.shape, report.placed[face.shape]), TRAY_TOP)
            if thickness is None:
                return "part lost"
            if abs(thickness - face.thickness) < THICKNESS_WITHIN:
                release(cell)
                report.placed[face.shape] += 1
                return ""
        if is_last:
            return put_back(cell, report)
        report.regrasped += 1
        found = regrasp(cell)
        if found is None:
            return "part lost"
        face = found
    return ""


def put_back(cell: Cell, report: Report) -> str:
    """Drop into the bin what was not recognised on the stand either, as two parts that hang together."""
    report.returned += 1
    cell.arm.move_by(z=HIGH - cell.arm.commanded_pose().z)
    cell.arm.move_to(Pose(*BIN, HIGH, *DOWN))
    release(cell)
    return "not recognised" if report.returned > MOST_RETURNS else ""


def regrasp(cell: Cell) -> Face | None:
    """Put the part on the stand, look at it there and take it again; None if it is lost."""
    if lower(cell, *STAND, STAND_TOP) is None:
        return None
    release(cell)
    face = vision.locate_on_stand(look(cell))
    return face if face is not None and grasp(cell, face) else None


def slot(shape: str, number: int) -> tuple[float, float]:
    """A place in a tray, base frame, m."""
    row, column = divmod(number, COLUMNS)
    x, y = TRAYS[shape]
    return x + (column - (COLUMNS - 1) / 2) * ACROSS, y + (row - (ROWS - 1) / 2) * ALONG


def lower(cell: Cell, x: float, y: float, top: float) -> float | None:
    """Lower the part until it rests on what is so high above the table.

    Returns:
        Its thickness, m; None if it was lost on the way.
    """
    cell.arm.move_by(z=HIGH - cell.arm.commanded_pose().z)
    cell.arm.move_to(Pose(x, y, HIGH, *DOWN))
    cell.force_sensor.zero()
    cell.arm.move_to(Pose(x, y, TABLE + top + LONGEST, *DOWN))
    if not (cell.suction.holding() and cell.arm.move_until_contact(z=-SEARCH, force=TOUCH, speed=SPEED)):
        return None
    return cell.arm.commanded_pose().z - TABLE - top + YIELD


def release(cell: Cell) -> None:
    """Let go of the part, and lift the cup."""
    cell.suction.off()
    wait_until(cell, lambda: cell.suction.vacuum() < VENTED, VENTED_WITHIN)
    cell.arm.move_by(z=HIGH - cell.arm.commanded_pose().z)


def wait_until(cell: Cell, condition: Callable[[], bool], seconds: float) -> bool:
    """Let time pass until the condition holds, at most so long; whether it holds."""
    end = cell.time + seconds
    while not condition():
        if cell.time >= end:
            return False
        cell.wait(0.01)
    return True
