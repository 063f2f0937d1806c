"""Take a box from the belt's stop with the suction cup, carry it, and set it down until it stands."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum

from pattern import HEIGHT, Slot
from station import LOOK, box_at_stop, feed, wait_until

from mutabot_cell import Cell, Pose
from mutabot_cell.move import Move

MASS = 0.8
"""Of a box, kg."""
BELT_TOP = 0.0
"""Heights are those of the robot's base frame, 0.9 m above the floor, m."""
BOX_AT_STOP = (0.5, 0.0)
"""The middle of a box that lies at the stop (x, y), m."""
PALLET_AT = (0.0, 0.48)
DECK_TOP = -0.2
CARRY = 0.2
"""Height at which the cup travels: a box below it clears a full pallet by 80 mm."""
OVER_STOP = (0, 32, 180, -87, 0, -61, 90)
OVER_PALLET = {False: (-90, 32, 180, -87, 0, -61, 0), True: (-90, 32, 180, -87, 0, -61, 90)}
"""Joint angles, degrees: the cup looks down, at about the height `CARRY`; over the pallet for a box that will
lie across or not."""
DOWN = (180, 0, 90)
DOWN_ON_PALLET = {False: (180, 0, 90), True: (180, 0, 180)}
"""Orientations of the cup, degrees."""

PALM = 0.06
"""From the distance sensor to the cup's lip, m."""
TOP_WITHIN = 0.01
"""By so much the top of a box may be measured higher or lower, m."""
PRESS = (0.003, 0.006)
"""How deep the cup is pressed on a box at the first try and at the second, m; its plunger gives way."""
VACUUM_WITHIN, VENTED_WITHIN = 1.0, 1.0
"""So long vacuum may take to come and to go, s."""
VENTED = 5e3
"""The cup holds nothing below this vacuum, Pa."""
SEARCH, SEARCH_SPEED, TOUCH = 0.015, 0.04, 6.0
"""A box is lowered slowly from so far above its place, m, at this speed, m/s, until it resists so hard, N."""
STANDS_WITHIN = 0.006
"""Where it resists may be so much higher or lower than its place, m: the plunger gives way by 4 mm."""


class Outcome(Enum):
    """How it ended."""

    FULL = "pallet full"
    NO_PALLET = "no pallet"
    WRONG_COUNT = "pallet is empty or not, against the count"
    NO_BOX = "no box came to the stop"
    WRONG_BOX = "what lies at the stop is not as high as a box"
    NO_VACUUM = "no vacuum on the box at the stop"
    NOT_LIFTED = "the light barrier at the stop is not free after lifting"
    LOST = "vacuum lost on the way"
    BLOCKED = "something lies in the place of the box, or nothing below it"
    NOT_RELEASED = "vacuum does not go"


class Stopped(Exception):  # noqa: N818  (what the robot does, not an error of the program)
    """The robot goes no further."""

    def __init__(self, outcome: Outcome) -> None:
        super().__init__(outcome.value)
        self.outcome = outcome


def pick(cell: Cell) -> None:
    """Take the box at the stop and lift it.

    Raises:
        Stopped: it is no box, or it does not come along.
    """
    x, y = BOX_AT_STOP
    top = BELT_TOP + HEIGHT
    cell.arm.move_to(Pose(x, y, CARRY, *DOWN))
    if abs(cell.sensors.distance() - (PALM + CARRY - top)) > TOP_WITHIN:
        raise Stopped(Outcome.WRONG_BOX)
    if not any(suck(cell, top - depth) for depth in PRESS):
        raise Stopped(Outcome.NO_VACUUM)
    cell.arm.set_payload(MASS, (0, 0, HEIGHT / 2))
    carry(cell, cell.arm.start_move_to(Pose(x, y, CARRY, *DOWN)))
    if box_at_stop(cell):
        raise Stopped(Outcome.NOT_LIFTED)


def suck(cell: Cell, height: float) -> bool:
    """Press the cup down to this height and wait for vacuum; without it, lift the cup again."""
    x, y = BOX_AT_STOP
    cell.arm.move_to(Pose(x, y, height, *DOWN))
    cell.suction.on()
    if wait_until(cell, cell.suction.holding, VACUUM_WITHIN):
        return True
    cell.suction.off()
    cell.arm.move_to(Pose(x, y, CARRY, *DOWN))
    return False


def carry(cell: Cell, move: Move, meanwhile: Callable[[], None] = lambda: None) -> None:
    """Let the move go on to its end as long as there is vacuum.

    Raises:
        Stopped: vacuum was lost; the arm has braked, the ejector goes on.
    """
    while not move.done:
        if not cell.suction.holding():
            move.stop()
            raise Stopped(Outcome.LOST)
        meanwhile()
        cell.wait(LOOK)
    move.wait()


def put(cell: Cell, slot: Slot) -> None:
    """Carry the box to its place and set it down. Meanwhile the belt brings the next one.

    Raises:
        Stopped: the box got lost, or cannot be set down.
    """
    x, y = PALLET_AT[0] + slot.x, PALLET_AT[1] + slot.y
    turn = DOWN_ON_PALLET[slot.across]
    cup = DECK_TOP + slot.z + HEIGHT
    carry(cell, cell.arm.start_move_joints(OVER_PALLET[slot.across]), meanwhile=lambda: feed(cell))
    cell.belt().stop()
    carry(cell, cell.arm.start_move_to(Pose(x, y, CARRY, *turn)))
    cell.force_sensor.zero()  # with the box, before anything can touch it
    carry(cell, cell.arm.start_move_to(Pose(x, y, cup + SEARCH, *turn)))
    stands = set_down(cell, cup)
    if stands:
        release(cell)
    carry_or_go(cell, Pose(x, y, CARRY, *turn), loaded=not stands)
    if not stands:
        raise Stopped(Outcome.BLOCKED)


def set_down(cell: Cell, cup: float) -> bool:
    """Lower the box until it resists; whether it does where its place is."""
    touched = cell.arm.move_until_contact(z=-2 * SEARCH, force=TOUCH, speed=SEARCH_SPEED)
    return touched and abs(cell.arm.commanded_pose().z - cup) < STANDS_WITHIN


def release(cell: Cell) -> None:
    """Let go of the box, and make sure that the cup does not hold it any more.

    Raises:
        Stopped: it does.
    """
    cell.suction.off()
    if not wait_until(cell, lambda: cell.suction.vacuum() < VENTED, VENTED_WITHIN):
        raise Stopped(Outcome.NOT_RELEASED)
    cell.arm.set_payload(0)


def carry_or_go(cell: Cell, pose: Pose, *, loaded: bool) -> None:
    """Move the cup in a straight line, with a box or without."""
    if loaded:
        carry(cell, cell.arm.start_move_to(pose))
    else:
        cell.arm.move_to(pose)
