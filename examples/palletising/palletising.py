"""Fill a pallet with 27 boxes that come on a belt."""

from __future__ import annotations

from dataclasses import dataclass

from handling import OVER_STOP, Outcome, Stopped, pick, put
from pattern import Slot, slots
from station import await_box, has_boxes_on_deck, has_pallet

from mutabot_cell import Cell

STAYS = (Outcome.LOST, Outcome.BLOCKED, Outcome.NOT_RELEASED, Outcome.NOT_LIFTED)
"""What a person has to look at: the robot stays where it is, with what it holds."""


@dataclass(frozen=True)
class Report:
    """What the robot tells its operator. The belt stands, the robot is at home unless `STAYS` says else.

    Attributes:
        outcome: how it ended.
        placed: how many boxes stand on the pallet; the next run goes on from there.
    """

    outcome: Outcome
    placed: int


def run(cell: Cell, placed: int = 0) -> Report:
    """Fill the pallet, on which so many boxes stand already."""
    outcome = Outcome.FULL
    try:
        check_pallet(cell, placed)
        for slot in slots()[placed:]:
            fill(cell, slot)
            placed += 1
    except Stopped as stopped:
        outcome = stopped.outcome
    cell.belt().stop()
    if outcome not in STAYS:
        cell.arm.home()
    return Report(outcome, placed)


def check_pallet(cell: Cell, placed: int) -> None:
    """Look whether the pallet is there and the count can be right.

    Raises:
        Stopped: it is not, or cannot.
    """
    if not has_pallet(cell):
        raise Stopped(Outcome.NO_PALLET)
    if has_boxes_on_deck(cell) != (placed > 0):
        raise Stopped(Outcome.WRONG_COUNT)


def fill(cell: Cell, slot: Slot) -> None:
    """Fetch a box and set it down in its place.

    Raises:
        Stopped: something is not as it should be.
    """
    cell.arm.move_joints(OVER_STOP)
    if not await_box(cell):
        raise Stopped(Outcome.NO_BOX)
    if not has_pallet(cell):
        raise Stopped(Outcome.NO_PALLET)
    pick(cell)
    put(cell, slot)
