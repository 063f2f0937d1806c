"""Put a pin into a housing by force, close it with a cover, and tighten four screws by torque and angle."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NoReturn

from screwdriver import Screwdriver
from station import Station

from mutabot_cell import Cell, Pose

DOWN = (0, 26, 180, -78, 0, -76, 90)
"""Joint angles, degrees: the gripper looks down, above the table."""
PIN, HOLE, TRAY, RACK, CHUTE = (0.50, -0.10), (0.50, 0.10), (0.50, 0.33), (0.56, -0.22), (0.36, -0.30)
"""Where pin, hole, cover and screwdriver should be, and where rejects are dropped; base frame, m."""
SCREWS = ((-0.068, -0.018), (0.068, 0.018), (0.068, -0.018), (-0.068, 0.018))
"""From the hole, m: crosswise, so that the cover is drawn down evenly."""
HIGH = 0.34
"""Height of the tool that is free of all, with whatever it holds, m."""
PIN_Z, HOVER, SEATED_Z, PIN_DROP_Z = 0.16, 0.190, 0.16, 0.17
"""To grip the standing pin; with it 5 mm above the hole; on the hole's ground; and above the chute, m."""
COVER_Z, COVER_HOVER, COVER_SEATED_Z, COVER_DROP_Z = 0.140, 0.199, 0.195, 0.13
"""To grip the cover; with it 4 mm above the rim; on the rim; and above the chute, m."""
DRIVER_Z, NOSE_HOVER, NOSE_Z = 0.215, 0.313, 0.308
"""To grip the screwdriver; with its nose 5 mm above the cover; and on the cover, m."""
PIN_GRIP, COVER_GRIP, DRIVER_GRIP = 120.0, 80.0, 200.0
"""Of the gripper, N: what it holds must neither slide nor turn."""
COVER_MASS, DRIVER_MASS, DRIVER_CENTRE = 0.2, 0.5, 0.045
"""Of cover and screwdriver, kg; the latter's centre of mass beyond the tool, m."""
FEEL_FORCE, FEEL_SPEED, FEEL_DEPTH = 4.0, 0.02, 0.008
"""With so many N and m/s the pin feels for the hole; so deep, 3 mm below the hole's edge, it is in it, m."""
STEP, RINGS = 0.0006, 3
"""Of the search: between places, less than the hole's clearance, m; and how many rings around the first."""
PUSH_FORCE, PUSH_TIME, PUSH_SPEED = 15.0, 5.0, 0.01
"""To the ground, N, s, m/s."""
SEATED_WITHIN = 0.0015
"""Of the height of a pin, a cover or a nose that is where it should be, m."""
PRESS_FORCE, PRESS_TIME = 20.0, 10.0
"""Of the nose on the cover, N, more than the bit presses; s, longer than any screw takes."""
FAST, SLOW = 15.0, 1.5
"""Of the screw while it runs freely, and for its last turn, rad/s."""
SLOW_FROM, LEAST_ANGLE, MOST_ANGLE = 23.0, 24.0, 28.0
"""The last turn begins here; a good screw is tight between these angles, rad."""
TIGHT = 1.6
"""Torque of a screw that holds, Nm."""
CLAMP_TIME = 1.0
"""Within which the clamp must have closed, s."""


class RejectError(Exception):
    """The assembly cannot be finished; says why."""


@dataclass
class Report:
    """What came of it. At the end the gripper is empty and the robot at home.

    Attributes:
        result: "good", or why not: "no block", "not clamped", "no pin", "not inserted", "no cover",
            "cover not seated", "no screwdriver", "screw crossed", "screw stripped", "screwdriver not back".
        tries: how often the pin felt for the hole.
        angles: by which the screws were turned, in the order of `SCREWS`, rad.
    """

    result: str = "good"
    tries: int = 0
    angles: list[float] = field(default_factory=list)


def run(station: Station) -> Report:
    """Assemble one housing. A reject switches the lamp on."""
    report = Report()
    station.lamp.off()
    try:
        clamp(station)
        station.cell.arm.move_joints(DOWN)
        assemble(station, report)
    except RejectError as reject:
        report.result = str(reject)
        station.lamp.on()
    station.cell.arm.home()
    station.clamp.open()
    return report


def assemble(station: Station, report: Report) -> None:
    """Put the pin, the cover and the screws in their places."""
    cell = station.cell
    fetch(cell, PIN, PIN_Z, PIN_GRIP, "no pin")
    x, y = insert(cell, report)
    fetch(cell, TRAY, COVER_Z, COVER_GRIP, "no cover")
    cover(cell, x, y)
    take_screwdriver(station)
    for across, along in SCREWS:
        fault = tighten(cell, station.driver, report, x + across, y + along)
        if fault:
            break
    put_back(station)
    if fault:
        raise RejectError(fault)


def clamp(station: Station) -> None:
    """Clamp the housing."""
    if not station.inputs.has_block():
        raise RejectError("no block")
    station.clamp.close()
    station.cell.wait(CLAMP_TIME)
    if not station.clamp.is_closed():
        raise RejectError("not clamped")


def down(x: float, y: float, z: float) -> Pose:
    """The gripper looks down."""
    return Pose(x, y, z, 180.0, 0.0, 90.0)


def fetch(cell: Cell, place: tuple[float, float], z: float, force: float, otherwise: str) -> None:
    """Take what stands at a place."""
    cell.gripper.set_force(force)
    cell.gripper.command(0, wait=True)
    cell.arm.move_to(down(*place, HIGH))
    cell.arm.move_to(down(*place, z))
    cell.gripper.command(1, wait=True)
    found = cell.gripper.holding()
    if not found:
        cell.gripper.command(0, wait=True)
    cell.arm.move_to(down(*place, HIGH))
    if not found:
        raise RejectError(otherwise)


def release(cell: Cell) -> None:
    """Let go, and rise."""
    cell.gripper.command(0, wait=True)
    cell.arm.set_payload(0.0)
    cell.arm.move_by(z=HIGH - cell.arm.commanded_pose().z)


def drop(cell: Cell, z: float, why: str) -> NoReturn:
    """Drop what the gripper holds into the chute."""
    cell.arm.move_by(z=HIGH - cell.arm.commanded_pose().z)
    cell.arm.move_to(down(*CHUTE, HIGH))
    cell.arm.move_to(down(*CHUTE, z))
    release(cell)
    raise RejectError(why)


def feel(cell: Cell, x: float, y: float, z: float) -> None:
    """Go to where forces are read anew, free of all."""
    cell.arm.move_to(down(x, y, HIGH))
    cell.arm.move_to(down(x, y, z))
    cell.wait(0.3)
    cell.force_sensor.zero()


def insert(cell: Cell, report: Report) -> tuple[float, float]:
    """Search for the hole, push the pin to its ground and let it go.

    Returns:
        Where the hole is, base frame, m.
    """
    arm = cell.arm
    feel(cell, *HOLE, HOVER)
    for report.tries, (x, y) in enumerate(search(), 1):
        arm.move_to(down(HOLE[0] + x, HOLE[1] + y, HOVER))
        if not arm.move_until_contact(z=-FEEL_DEPTH, force=FEEL_FORCE, speed=FEEL_SPEED):
            arm.push(x=0.0, y=0.0, z=-PUSH_FORCE, seconds=PUSH_TIME, travel=0.05, speed=PUSH_SPEED)
            pose = cell.sensors.tool_pose()
            if abs(pose.z - SEATED_Z) > SEATED_WITHIN:
                break
            release(cell)
            return pose.x, pose.y
    drop(cell, PIN_DROP_Z, "not inserted")


def search() -> list[tuple[float, float]]:
    """Places around the first one, the nearest first, m."""
    across = range(-RINGS, RINGS + 1)
    places = [(i * STEP, j * STEP) for i in across for j in across]
    return sorted(places, key=lambda place: place[0] ** 2 + place[1] ** 2)


def cover(cell: Cell, x: float, y: float) -> None:
    """Put the cover on the rim, and let it go if it rests there."""
    cell.arm.set_payload(COVER_MASS)
    feel(cell, x, y, COVER_HOVER)
    cell.arm.move_until_contact(z=-0.01, force=FEEL_FORCE, speed=FEEL_SPEED)
    if abs(cell.sensors.tool_pose().z - COVER_SEATED_Z) > SEATED_WITHIN:
        drop(cell, COVER_DROP_Z, "cover not seated")
    release(cell)


def take_screwdriver(station: Station) -> None:
    """Take the screwdriver out of its rack."""
    if not station.inputs.has_driver():
        raise RejectError("no screwdriver")
    fetch(station.cell, RACK, DRIVER_Z, DRIVER_GRIP, "no screwdriver")
    station.cell.arm.set_payload(DRIVER_MASS, (0.0, 0.0, DRIVER_CENTRE))


def put_back(station: Station) -> None:
    """Put the screwdriver into its rack."""
    cell = station.cell
    cell.arm.move_to(down(*RACK, HIGH))
    cell.arm.move_to(down(*RACK, DRIVER_Z))
    release(cell)
    if not station.inputs.has_driver():
        raise RejectError("screwdriver not back")


def tighten(cell: Cell, driver: Screwdriver, report: Report, x: float, y: float) -> str:
    """Drive a screw: to a torque, within a range of angles, while the nose is pressed on the cover.

    Returns:
        What is wrong with it; nothing if it is tight.
    """
    feel(cell, x, y, NOSE_HOVER)
    cell.arm.move_until_contact(z=-0.01, force=FEEL_FORCE, speed=FEEL_SPEED)
    press = cell.arm.start_push(x=0.0, y=0.0, z=-PRESS_FORCE, seconds=PRESS_TIME)
    driver.start(FAST)
    while driver.torque() < TIGHT and driver.angle() < SLOW_FROM:
        cell.wait(0.01)
    driver.start(SLOW)
    while driver.torque() < TIGHT and driver.angle() < MOST_ANGLE:
        cell.wait(0.01)
    driver.stop()
    press.stop()
    report.angles.append(driver.angle())
    cell.arm.move_to(down(x, y, HIGH))
    if driver.angle() < LEAST_ANGLE:
        return "screw crossed"
    return "screw stripped" if driver.angle() >= MOST_ANGLE else ""
