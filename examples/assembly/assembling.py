"""Put a pin into the hole of a block by force, and secure it with a set screw by torque and angle."""

from __future__ import annotations

from dataclasses import dataclass

from station import Spindle, Station

from mutabot_cell import Cell, Pose

DOWN = (0, 26, 180, -78, 0, -76, 90)
"""Joint angles, degrees: the gripper looks down, above the table."""
PIN_X, PIN_Y, HOLE_X, HOLE_Y = 0.50, -0.10, 0.50, 0.10
"""Where pin and hole should be; base frame, m."""
CHUTE_X, CHUTE_Y = 0.40, -0.30
"""Where rejects are dropped, m."""
HIGH, PIN_Z, HOVER, SEATED_Z = 0.25, 0.16, 0.190, 0.16
"""Heights of the tool: free of all; to grip the standing pin; with the pin 5 mm above the block; and with the
pin on the ground of the hole, m."""
GRIP_FORCE = 120.0
"""Of the gripper, N: the pin must not slide while it is pushed."""
FEEL_FORCE, FEEL_SPEED, FEEL_DEPTH = 4.0, 0.02, 0.008
"""With so many N and m/s the pin feels for the hole; so deep, 3 mm below the block's top, it is in it, m."""
STEP, RINGS = 0.0006, 3
"""Of the search: between places, less than the hole's clearance, m; and how many rings around the first."""
PUSH_FORCE, PUSH_TIME, PUSH_SPEED = 15.0, 6.0, 0.01
"""To the ground, N, s, m/s."""
SEATED_WITHIN = 0.0015
"""Of the height of a pin that is in, m."""
SCREW_SPEED, SCREW_SLOW = 12.0, 1.5
"""Of the spindle while the screw runs freely, and for its last turn, rad/s."""
SLOW_FROM, LEAST_ANGLE, MOST_ANGLE = 26.0, 26.5, 31.0
"""The last turn begins here; a good screw is tight between these angles, rad."""
TIGHT = 1.6
"""Torque of a screw that holds, Nm."""


@dataclass(frozen=True)
class Report:
    """What came of it. At the end the spindle stands, the gripper is empty and the robot at home.

    Attributes:
        result: "good", "no block", "no pin", "not inserted", "screw crossed" or "screw stripped".
        tries: how often the pin felt for the hole.
        angle: by which the screw was turned, rad.
    """

    result: str
    tries: int = 0
    angle: float = 0.0


def run(station: Station) -> Report:
    """Assemble one block. A reject switches the lamp on."""
    cell = station.cell
    station.lamp.off()
    if not station.inputs.has_block():
        return Report("no block")
    cell.arm.move_joints(DOWN)
    if not fetch(cell):
        cell.arm.home()
        return Report("no pin")
    tries, is_in = insert(cell)
    if not is_in:
        drop(cell)
        station.lamp.on()
        cell.arm.home()
        return Report("not inserted", tries)
    result, angle = tighten(cell, station.spindle)
    if result != "good":
        station.lamp.on()
    cell.gripper.command(0, wait=True)
    cell.arm.move_by(z=HIGH - SEATED_Z)
    cell.arm.home()
    return Report(result, tries, angle)


def down(x: float, y: float, z: float) -> Pose:
    """The gripper looks down."""
    return Pose(x, y, z, 180.0, 0.0, 90.0)


def fetch(cell: Cell) -> bool:
    """Take the pin out of the feeder; returns whether there was one."""
    cell.gripper.set_force(GRIP_FORCE)
    cell.gripper.command(0, wait=True)
    cell.arm.move_to(down(PIN_X, PIN_Y, HIGH))
    cell.arm.move_to(down(PIN_X, PIN_Y, PIN_Z))
    cell.gripper.command(1, wait=True)
    found = cell.gripper.holding()
    if not found:
        cell.gripper.command(0, wait=True)
    cell.arm.move_to(down(PIN_X, PIN_Y, HIGH))
    return found


def insert(cell: Cell) -> tuple[int, bool]:
    """Search for the hole and push the pin to its ground.

    Returns:
        How often the pin felt for the hole, and whether it is in.
    """
    arm = cell.arm
    arm.move_to(down(HOLE_X, HOLE_Y, HIGH))
    arm.move_to(down(HOLE_X, HOLE_Y, HOVER))
    cell.wait(0.3)
    cell.force_sensor.zero()
    for tries, (x, y) in enumerate(search(), 1):
        arm.move_to(down(HOLE_X + x, HOLE_Y + y, HOVER))
        if not arm.move_until_contact(z=-FEEL_DEPTH, force=FEEL_FORCE, speed=FEEL_SPEED):
            arm.push(x=0.0, y=0.0, z=-PUSH_FORCE, seconds=PUSH_TIME, travel=0.05, speed=PUSH_SPEED)
            return tries, abs(cell.sensors.tool_pose().z - SEATED_Z) < SEATED_WITHIN
    arm.move_to(down(HOLE_X, HOLE_Y, HIGH))
    return tries, False


def search() -> list[tuple[float, float]]:
    """Places around the first one, the nearest first, m."""
    across = range(-RINGS, RINGS + 1)
    places = [(i * STEP, j * STEP) for i in across for j in across]
    return sorted(places, key=lambda place: place[0] ** 2 + place[1] ** 2)


def tighten(cell: Cell, spindle: Spindle) -> tuple[str, float]:
    """Drive the screw: to a torque, within a range of angles.

    Returns:
        "good", "screw crossed" or "screw stripped", and the angle, rad.
    """
    spindle.start(SCREW_SPEED)
    while spindle.torque() < TIGHT and spindle.angle() < SLOW_FROM:
        cell.wait(0.01)
    spindle.start(SCREW_SLOW)
    while spindle.torque() < TIGHT and spindle.angle() < MOST_ANGLE:
        cell.wait(0.01)
    spindle.stop()
    angle = spindle.angle()
    if angle < LEAST_ANGLE:
        return "screw crossed", angle
    return ("screw stripped" if angle >= MOST_ANGLE else "good"), angle


def drop(cell: Cell) -> None:
    """Drop the pin into the chute."""
    cell.arm.move_to(down(HOLE_X, HOLE_Y, HIGH))
    cell.arm.move_to(down(CHUTE_X, CHUTE_Y, HIGH))
    cell.gripper.command(0, wait=True)
