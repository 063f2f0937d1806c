"""The program of the left robot: it hands bars from the infeed to the right one, in the air."""

from __future__ import annotations

from moving import GRIP_FORCE, Robot
from station import LEFT_HOME, Station

from mutabot_cell import Pose

FIRST_X, FIRST_Y, NEXT_Y = 0.34, -0.28, -0.14
"""Where the near end of the first bar is gripped, and from there to that of the next one; base frame, m."""
COUNT = 2
"""Of the places on the infeed."""
ABOVE, LOW, DROP = 0.25, 0.13, 0.138
"""Heights of the tool: free of the bars, in the upper half of one, and some millimetres before a bar that
hangs askew touches the table, m."""
BORDER_Y = -0.20
"""The robot waits here with a bar until the zone in the middle is its own, m."""
MIDDLE_X, MIDDLE_Y, MIDDLE_Z = 0.54, 0.0, 0.35
"""Where it presents the near end of a bar, m."""
UP = 0.12
"""Above a bar the gripper is out of the other robot's way, m."""
ZONE_WITHIN, TAKEN_WITHIN, ANSWER_WITHIN = 12.0, 15.0, 2.0
"""How long the other robot may take to leave the zone, to grip, and to answer, s."""


def down(x: float, y: float, z: float) -> Pose:
    """The gripper looks down and closes across a bar."""
    return Pose(x, y, z, 180.0, 0.0, 90.0)


async def give(station: Station) -> list[str]:
    """Hand over all bars.

    Returns:
        What came of each: "given", "nothing there", "zone taken", "not taken" or "no answer".
    """
    robot, signals = Robot(station, "left"), station.signals
    robot.gripper.set_force(GRIP_FORCE)
    await robot.open()
    results: list[str] = []
    for number in range(COUNT):
        results.append(await give_one(station, robot, FIRST_Y + number * NEXT_Y))
        if results[-1] != "given":
            break
    signals.set("ended")
    await robot.go(lambda speed: robot.arm.start_move_joints(LEFT_HOME, speed=speed))
    return results


async def give_one(station: Station, robot: Robot, y: float) -> str:
    """Fetch the bar that lies there, and hand it over."""
    arm = robot.arm
    if not await fetch(robot, y):
        return "nothing there"
    await robot.go(lambda speed: arm.start_move_to(down(FIRST_X, BORDER_Y, MIDDLE_Z), speed=speed))
    if not await robot.wait(lambda: station.zone.request("left"), ZONE_WITHIN):
        await put_back(robot, y)
        return "zone taken"
    await robot.go(lambda speed: arm.start_move_to(down(MIDDLE_X, MIDDLE_Y, MIDDLE_Z), speed=speed))
    result = await hand_over(station, robot)
    if result == "not taken":
        await put_back(robot, y)
        station.zone.release("left")
    return result


async def fetch(robot: Robot, y: float) -> bool:
    """Take the bar that lies there; returns whether there is one."""
    arm = robot.arm
    await robot.go(lambda speed: arm.start_move_to(down(FIRST_X, y, ABOVE), speed=speed))
    await robot.go(lambda speed: arm.start_move_to(down(FIRST_X, y, LOW), speed=speed))
    found = await robot.close()
    if not found:
        await robot.open()
    await robot.go(lambda speed: arm.start_move_to(down(FIRST_X, y, ABOVE), speed=speed))
    return found


async def hand_over(station: Station, robot: Robot) -> str:
    """Present the bar, let go of it when the other robot holds it, and leave the zone."""
    signals = station.signals
    signals.set("presented")
    if not await robot.wait(lambda: signals.is_on("gripped"), TAKEN_WITHIN):
        signals.reset("presented")
        return "not taken"
    await robot.open()
    up = down(MIDDLE_X, MIDDLE_Y, MIDDLE_Z + UP)
    await robot.go(lambda speed: robot.arm.start_move_to(up, speed=speed))
    border = down(FIRST_X, BORDER_Y, MIDDLE_Z + UP)
    await robot.go(lambda speed: robot.arm.start_move_to(border, speed=speed))
    station.zone.pass_on("left", "right")
    signals.set("released")
    signals.reset("presented")
    if not await robot.wait(lambda: not signals.is_on("gripped"), ANSWER_WITHIN):
        signals.reset("released")
        return "no answer"
    signals.reset("released")
    return "given"


async def put_back(robot: Robot, y: float) -> None:
    """Put the bar back where it was."""
    arm = robot.arm
    await robot.go(lambda speed: arm.start_move_to(down(FIRST_X, BORDER_Y, MIDDLE_Z), speed=speed))
    await robot.go(lambda speed: arm.start_move_to(down(FIRST_X, y, ABOVE), speed=speed))
    await robot.go(lambda speed: arm.start_move_to(down(FIRST_X, y, DROP), speed=speed))
    await robot.open()
    await robot.go(lambda speed: arm.start_move_to(down(FIRST_X, y, ABOVE), speed=speed))
