"""The program of the right robot: it takes bars out of the left one's gripper and puts them down."""

from __future__ import annotations

from moving import GRIP_FORCE, Robot
from station import Station

from mutabot_cell import Pose

WAITING_X, WAITING_Y, WAITING_Z = 0.39, -0.20, 0.35
"""Where it waits outside the zone in the middle; base frame, m."""
MIDDLE_X, MIDDLE_Y, MIDDLE_Z = 0.54, 0.0, 0.35
"""Where the far end of a bar is presented, m."""
UP, LIFT = 0.12, 0.02
"""Above a presented bar, and by how much a bar is lifted when it is taken, m."""
FIRST_Y, NEXT_Y, PLACE_X = -0.28, -0.14, 0.34
"""Where the far end of the first bar is put down, and from there to the next one, m."""
ABOVE, LOW = 0.25, 0.138
"""Heights of the tool: free of the bars, and some millimetres before a bar touches the table, since it may
hang askew, m."""
PRESENTED_WITHIN, RELEASED_WITHIN, FREE_WITHIN = 60.0, 20.0, 15.0
"""How long the other robot may take to present a bar and to let go, and the outfeed to be free, s."""


def down(x: float, y: float, z: float) -> Pose:
    """The gripper looks down and closes across a bar."""
    return Pose(x, y, z, 180.0, 0.0, -90.0)


async def take(station: Station) -> list[str]:
    """Take all bars that are presented, until the other robot has ended.

    Returns:
        What came of each: "put down", "not gripped", "not released", "outfeed full" or "not presented".
    """
    robot, signals = Robot(station, "right"), station.signals
    robot.gripper.set_force(GRIP_FORCE)
    await robot.open()
    await robot.go(lambda speed: robot.arm.start_move_to(down(WAITING_X, WAITING_Y, WAITING_Z), speed=speed))
    results: list[str] = []
    while True:
        is_there = await robot.wait(
            lambda: signals.is_on("presented") or signals.is_on("ended"), PRESENTED_WITHIN
        )
        if not is_there:
            return [*results, "not presented"]
        if not signals.is_on("presented"):
            signals.reset("ended")
            return results
        results.append(await take_one(station, robot, FIRST_Y + len(results) * NEXT_Y))
        if results[-1] != "put down":
            return results


async def take_one(station: Station, robot: Robot, y: float) -> str:
    """Take the bar that is presented, and put it down."""
    arm = robot.arm
    result = await grip(station, robot)
    if result:
        return result
    lifted = down(MIDDLE_X, MIDDLE_Y, MIDDLE_Z + LIFT)
    await robot.go(lambda speed: arm.start_move_to(lifted, speed=speed))
    if not await robot.wait(station.outfeed.is_free, FREE_WITHIN):
        return "outfeed full"
    await robot.go(lambda speed: arm.start_move_to(down(WAITING_X, WAITING_Y, WAITING_Z), speed=speed))
    station.zone.release("right")
    await robot.go(lambda speed: arm.start_move_to(down(PLACE_X, y, ABOVE), speed=speed))
    await robot.go(lambda speed: arm.start_move_to(down(PLACE_X, y, LOW), speed=speed))
    await robot.open()
    await robot.go(lambda speed: arm.start_move_to(down(PLACE_X, y, ABOVE), speed=speed))
    await robot.go(lambda speed: arm.start_move_to(down(WAITING_X, WAITING_Y, WAITING_Z), speed=speed))
    return "put down"


async def grip(station: Station, robot: Robot) -> str:
    """Grip the bar beside the other robot, and get the zone; returns what went wrong, "" if nothing."""
    arm, signals = robot.arm, station.signals
    await robot.go(lambda speed: arm.start_move_to(down(MIDDLE_X, MIDDLE_Y, MIDDLE_Z + UP), speed=speed))
    await robot.go(lambda speed: arm.start_move_to(down(MIDDLE_X, MIDDLE_Y, MIDDLE_Z), speed=speed))
    if not await robot.close():
        await leave(robot)
        return "not gripped"
    signals.set("gripped")
    if not await robot.wait(lambda: signals.is_on("released"), RELEASED_WITHIN):
        await leave(robot)
        signals.reset("gripped")
        return "not released"
    await robot.wait(lambda: station.zone.request("right"), RELEASED_WITHIN)
    signals.reset("gripped")
    return ""


async def leave(robot: Robot) -> None:
    """Open the gripper and leave the zone without a bar."""
    arm = robot.arm
    await robot.open()
    await robot.go(lambda speed: arm.start_move_to(down(MIDDLE_X, MIDDLE_Y, MIDDLE_Z + UP), speed=speed))
    await robot.go(lambda speed: arm.start_move_to(down(WAITING_X, WAITING_Y, WAITING_Z), speed=speed))
