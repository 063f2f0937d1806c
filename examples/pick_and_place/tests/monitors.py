"""What must hold at every moment. Lengths in m, world frame; speeds in m/s."""

from __future__ import annotations

import math

from mutabot.cells import Cell

CONVEYOR_TOP, CONVEYOR_EDGE = 1.0, 0.1
"""Height of the conveyor, and the x at which it begins."""
TABLE_TOP, TABLE_EDGE = 0.76, -0.2
"""Height of the table, and the x at which it ends."""
BASE_HEIGHT = 0.9

FINGERS = 0.021
"""The fingers of a gripper that looks down reach this far below the tool point."""
FINGER_CLEARANCE = 0.005
"""No nearer to conveyor and table; the program means to keep 0.009."""
SINKING = 0.002
"""What lies or lands on a surface sinks in a little: contacts are soft. 0.001 is usual."""
OPEN = 0.052
"""Fingers further apart than this do not touch a box of 0.05."""
LOW = 0.005
"""A box may fall this deep when it is let go: the program means 0.0015; the noise of its camera is 0.0005."""
LARGEST_TILT = 3.0
"""Degrees. A joint move between two poses that both look down leans over by 1.3° on its way."""
CARRYING_HEIGHT, PUSHING_SPEED = 0.1, 0.15
"""Nearer to a surface than this a box may only be pushed by closing fingers: 0.05 each,
and a little more at the moment they touch it."""


def watch_fingers(cell: Cell) -> None:
    """For every test case: no finger touches what the box lies on."""
    cell.always(lambda: _fingers_are_clear(cell), "the fingers keep clear of conveyor and table")


def watch_box(cell: Cell) -> None:
    """For test cases in which no box gets lost: it is gripped, lifted, carried and set down gently."""
    motion = Motion(cell)
    cell.always(lambda: height(cell) > -SINKING, "the box is not pressed into conveyor or table")
    cell.always(lambda: cell.truth.opening() < OPEN or height(cell) < LOW, "the box is never dropped")
    cell.always(lambda: motion.sideways() < PUSHING_SPEED or height(cell) > CARRYING_HEIGHT, "carried high")


def watch_tilt(cell: Cell) -> None:
    """For test cases in which the fingers hold the box at once."""
    cell.always(lambda: cell.truth.box_tilt() < LARGEST_TILT, "the box stays upright")


def height(cell: Cell) -> float:
    """Of the box above conveyor or table; between them, above the floor."""
    box = cell.truth.box_position()
    return box.z - _top(box.x)


def _top(x: float) -> float:
    if x > CONVEYOR_EDGE:
        return CONVEYOR_TOP
    return TABLE_TOP if x < TABLE_EDGE else 0.0


def _fingers_are_clear(cell: Cell) -> bool:
    tool = cell.truth.tool_pose()
    return tool.z + BASE_HEIGHT - FINGERS > _top(tool.x) + FINGER_CLEARANCE


class Motion:
    """The box's speed, measured from tick to tick."""

    def __init__(self, cell: Cell) -> None:
        self._cell = cell
        self._time = cell.time
        self._position = cell.truth.box_position()

    def sideways(self) -> float:
        """Horizontal speed since the last call; 0 if no time has passed."""
        before, self._position = self._position, self._cell.truth.box_position()
        passed, self._time = self._cell.time - self._time, self._cell.time
        way = math.hypot(self._position.x - before.x, self._position.y - before.y)
        return way / passed if passed > 0 else 0.0
