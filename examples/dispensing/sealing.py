"""Lay a bead of sealant along the seam of a housing, wherever its fixture has put it down."""

from __future__ import annotations

import math
from dataclasses import dataclass

from station import Dispenser, SeamSensor, Station

from mutabot_cell import Cell, Pose

SEAM = ((-0.06, -0.10), (-0.06, 0.04), (-0.02, 0.10), (0.06, 0.10), (0.06, -0.10))
"""Corners of the seam as drawn, m; the housing's frame, whose origin is the middle of its top."""
ROUND = 0.012
"""The nozzle leaves the straight line so far before a corner, m: the groove is milled like this."""
NOMINAL_X, NOMINAL_Y, NOMINAL_Z = 0.46, 0.02, 0.13
"""Where the fixture should put the housing's frame down; base frame, m."""

SPEED = 0.06
"""Along the seam, m/s: with the dispenser's flow this makes a bead 4 mm wide."""
STANDOFF = 0.002
"""From the nozzle's tip to the housing, m: half of the bead's width."""
RUN_IN = 0.010
"""Before the seam the nozzle speeds up on its straight continuation, m."""
RUN_OUT = 0.010
"""Behind the seam it slows down, m."""
VALVE = 0.05
"""From the command until the sealant flows, or stops to flow, s: dead time and half of the rise."""
MEASURING_HEIGHT = 0.025
"""Of the nozzle above the housing while the sensor looks for the seam, m: the middle of its range."""
RETREAT = 0.06
"""Above the housing nothing is in the nozzle's way, m."""
LEAST_LEVEL = 0.10
"""Of the cartridge, so that the bead does not end before the seam."""
CLOGGED = 6.0e5
"""The pressure before an open needle stays below this, Pa."""
LARGEST_SHIFT, LARGEST_TURN = 0.006, 1.5
"""The fixture puts a housing down no further off than this, m and degrees: else something is under it."""
ABOVE = (12, 26, 180, -78, 0, -76, 90)
"""Joint angles, degrees: the nozzle looks down, high above the housing."""


@dataclass(frozen=True)
class Report:
    """What the robot tells its operator. At the end the valve is shut and the robot at home.

    Attributes:
        result: "sealed", "no housing", "misplaced", "cartridge empty" or "clogged".
        shift_x, shift_y, turn: by how much the housing lay off, m and degrees, as far as it was measured.
    """

    result: str
    shift_x: float = 0.0
    shift_y: float = 0.0
    turn: float = 0.0


@dataclass(frozen=True)
class Frame:
    """The housing's frame in the base frame: m, and degrees about the vertical."""

    x: float
    y: float
    z: float
    turn: float

    def pose(self, x: float, y: float, height: float, facing: float = 90.0) -> Pose:
        """The nozzle above a place of the housing, looking down.

        Args:
            x, y, height: in the housing's frame, m.
            facing: of the sensor, against the housing, degrees: 0 measures along its x, 90 along its y.
        """
        turned = math.radians(self.turn)
        across = x * math.cos(turned) - y * math.sin(turned)
        along = x * math.sin(turned) + y * math.cos(turned)
        return Pose(self.x + across, self.y + along, self.z + height, 180.0, 0.0, facing + self.turn)


def run(station: Station) -> Report:
    """Seal the housing that lies in the fixture."""
    cell, dispenser = station.cell, station.dispenser
    dispenser.close()
    if dispenser.level() < LEAST_LEVEL:
        cell.arm.home()
        return Report("cartridge empty")
    cell.arm.move_joints(ABOVE)
    frame = locate(cell, station.seam_sensor)
    if frame is None:
        cell.arm.home()
        return Report("no housing")
    shift_x, shift_y = frame.x - NOMINAL_X, frame.y - NOMINAL_Y
    if math.hypot(shift_x, shift_y) > LARGEST_SHIFT or abs(frame.turn) > LARGEST_TURN:
        result = "misplaced"
    else:
        result = seal(cell, dispenser, frame)
    cell.arm.move_by(z=RETREAT)
    cell.arm.home()
    return Report(result, shift_x, shift_y, frame.turn)


def locate(cell: Cell, sensor: SeamSensor) -> Frame | None:
    """Measure where the housing lies; None if there is no seam where one should be.

    Two places of the first side give its place across and its direction, one of the side that runs across it
    its place along. The first measurement gives the height as well.
    """
    nominal = Frame(NOMINAL_X, NOMINAL_Y, NOMINAL_Z, 0.0)
    (side, near), (_, far) = SEAM[0], SEAM[1]
    end_x, end_y = (SEAM[2][0] + SEAM[3][0]) / 2, SEAM[3][1]
    cell.arm.move_to(nominal.pose(side, near + 0.02, RETREAT, facing=0.0))
    cell.arm.move_by(z=MEASURING_HEIGHT - RETREAT)
    first = sensor.read()
    cell.arm.move_by(y=far - near - 0.04)
    second = sensor.read()
    cell.arm.move_to(nominal.pose(end_x, end_y, MEASURING_HEIGHT))
    third = sensor.read()
    if first is None or second is None or third is None:
        return None
    turn = math.atan2(first.offset - second.offset, far - near - 0.04)
    across = (first.offset + second.offset) / 2 + (near + far) / 2 * turn
    along = third.offset - end_x * turn
    height = NOMINAL_Z + MEASURING_HEIGHT - first.distance
    return Frame(NOMINAL_X + across, NOMINAL_Y + along, height, math.degrees(turn))


def seal(cell: Cell, dispenser: Dispenser, frame: Frame) -> str:
    """Lay the bead; returns what came of it, as in the report. The valve ends shut."""
    (x, y), (last_x, last_y) = SEAM[0], SEAM[-1]
    cell.arm.move_to(frame.pose(x, y - RUN_IN, RETREAT))
    cell.arm.move_by(z=STANDOFF - RETREAT)
    path = cell.arm.new_path()
    for corner_x, corner_y in SEAM[1:-1]:
        path.line_to(frame.pose(corner_x, corner_y, STANDOFF), blend=ROUND)
    path.line_to(frame.pose(last_x, last_y - RUN_OUT, STANDOFF))
    move = path.start(SPEED)
    while not move.done and path.travelled() < RUN_IN - SPEED * VALVE:
        cell.wait(0.01)
    dispenser.open()
    while not move.done and path.travelled() < path.length() - RUN_OUT - SPEED * VALVE:
        cell.wait(0.01)
        if dispenser.pressure() > CLOGGED:
            dispenser.close()
            move.stop()
            return "clogged"
    dispenser.close()
    move.wait()
    return "sealed"
