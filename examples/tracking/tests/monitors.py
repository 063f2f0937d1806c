"""What must hold at every moment. Lengths in m, world frame; speeds in m/s."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable

from mutabot_cell import Cell, Position

BELT_TOP, BELT_EDGE = 1.0, 0.1
"""Height of the belt, and the x at which it begins."""
TABLE_TOP, TABLE_EDGE = 0.76, -0.2
"""Height of the table, and the x at which it ends."""
BASE_HEIGHT = 0.9

FINGERS = 0.021
"""The fingers of a gripper that looks down reach this far below the tool point."""
FINGER_CLEARANCE = 0.005
"""No nearer to belt and table; the program means to keep 0.009."""
SINKING = 0.002
"""What lies or lands on a surface sinks in a little: contacts are soft. 0.001 is usual."""
LOOSE, OPEN = 0.052, 0.08
"""Fingers further apart than this do not hold a box of 0.05; and are as good as open."""
NEAR, STANDING = 0.1, 0.05
"""Nearer to a surface than this, the tool stands still over it while the fingers open or close: below this
speed, on the belt as seen from it. (A finger that meets the box makes it twitch at 0.01.)"""
SWING = 0.1
"""The speed of the tool is its mean over so many seconds: the belt's wanders faster than the arm can follow,
to and fro by a few millimetres, which the fingers centre."""
LOW = 0.005
"""A box may fall this deep when it is let go: the program means 0.0015; the noise of its camera is 0.0005."""
LARGEST_TILT = 3.0
"""Degrees. A joint move between two poses that both look down leans over by 1.3° on its way."""
CARRYING_HEIGHT, PUSHING_SPEED = 0.1, 0.15
"""Nearer to a surface than this a box may only be pushed by closing fingers: 0.05 each. Faster is only the
jerk with which they meet it."""
WINDOW = 0.02
"""The speed of a box is its mean over so many seconds: the jerk lasts a tick or two, and moves it by less
than a millimetre."""
AISLE = 0.0
"""Behind the robot, on the side where no table stands (x and y below this), people pass."""
PAST = 0.4
"""No box of the batch goes further along the belt than this (y): it would be beyond the arm's reach."""


def watch_gripper(cell: Cell) -> None:
    """For every test case: the fingers touch nothing, the arm waits for them and keeps to its side."""
    place = once_per_tick(cell, cell.truth.tool_position)
    motion = Motion(cell, place, SWING)

    def clearance() -> float:
        tool = place()
        return tool.z + BASE_HEIGHT - FINGERS - _top(tool.x)

    cell.always(lambda: clearance() > FINGER_CLEARANCE, "the fingers keep clear of belt and table")
    cell.always(lambda: place().x > AISLE or place().y > AISLE, "the arm keeps out of the aisle")
    cell.always(
        lambda: motion.speed() < STANDING or clearance() > NEAR or not LOOSE < cell.truth.opening() < OPEN,
        "the arm waits for the fingers",
    )


def watch_box(cell: Cell, name: str) -> None:
    """For boxes that are picked and set down: gently, and in time."""
    place = once_per_tick(cell, lambda: cell.truth.box_position(name))
    motion = Motion(cell, place, WINDOW)

    def height() -> float:
        return place().z - _top(place().x)

    def is_past() -> bool:
        return place().y > PAST and place().x > BELT_EDGE and height() < LOW

    cell.always(lambda: height() > -SINKING, f"{name} is not pressed into belt or table")
    cell.always(lambda: cell.truth.opening() < LOOSE or height() < LOW, f"{name} is never dropped")
    cell.always(
        lambda: motion.sideways() < PUSHING_SPEED or height() > CARRYING_HEIGHT, f"{name} is carried high"
    )
    cell.always(lambda: cell.truth.box_tilt(name) < LARGEST_TILT, f"{name} stays upright")
    cell.always(lambda: not is_past(), f"{name} does not get past the robot")


def once_per_tick(cell: Cell, read: Callable[[], Position]) -> Callable[[], Position]:
    """The same reading, taken once however many conditions ask for it."""
    time, place = cell.time, read()

    def reading() -> Position:
        nonlocal time, place
        if cell.time != time:
            time, place = cell.time, read()
        return place

    return reading


def _top(x: float) -> float:
    if x > BELT_EDGE:
        return BELT_TOP
    return TABLE_TOP if x < TABLE_EDGE else 0.0


class Motion:
    """A mean speed over what lies below, maybe the moving belt, in the last `window` seconds.

    It is 0 before any time has passed.
    """

    def __init__(self, cell: Cell, position: Callable[[], Position], window: float) -> None:
        self._cell = cell
        self._position = position
        self._window = window
        self._time, self._place, self._travel = cell.time, position(), cell.truth.belt_position()
        self._steps: deque[tuple[float, tuple[float, float, float]]] = deque()

    def speed(self) -> float:
        """In all directions."""
        return math.hypot(*self._velocity())

    def sideways(self) -> float:
        """In the horizontal directions."""
        return math.hypot(*self._velocity()[:2])

    def _velocity(self) -> tuple[float, float, float]:
        before, self._place = self._place, self._position()
        ran, self._travel = self._travel, self._cell.truth.belt_position()
        passed, self._time = self._cell.time - self._time, self._cell.time
        now = self._place
        below = self._travel - ran if now.x > BELT_EDGE else 0.0
        if passed > 0:
            way = (now.x - before.x, now.y - before.y - below, now.z - before.z)
            self._steps.append((passed, way))
        took = sum(seconds for seconds, _ in self._steps)
        while len(self._steps) > 1 and took - self._steps[0][0] >= self._window:
            took -= self._steps.popleft()[0]
        x, y, z = (sum(way[axis] for _, way in self._steps) / took if took else 0.0 for axis in range(3))
        return x, y, z
