"""What stands around the robot: the belt that brings boxes to a stop, the pallet, and light barriers."""

from __future__ import annotations

from collections.abc import Callable

from mutabot_cell import Cell

AT_STOP, PALLET, DECK = "box at the stop", "pallet", "on the deck"
"""Light barriers: before the belt's stop, through the pallet, and just above the pallet's deck."""

BELT_SPEED = 0.2
"""m/s."""
STANDING = 0.005
"""The belt stands when its encoder tells less than this, m/s."""
PATIENCE = 2.5
"""So long the belt runs for a box, s: it brings one every 0.2 m."""
BRAKING = 1.0
"""Longer than the belt takes to stop, s."""
LOOK = 0.01
"""From one look at a sensor to the next, s."""


def box_at_stop(cell: Cell) -> bool:
    """Whether a box has come to the belt's stop."""
    return cell.sensors.light_barriers.is_interrupted(AT_STOP)


def has_pallet(cell: Cell) -> bool:
    """Whether a pallet stands in its place."""
    return cell.sensors.light_barriers.is_interrupted(PALLET)


def has_boxes_on_deck(cell: Cell) -> bool:
    """Whether something stands on the pallet."""
    return cell.sensors.light_barriers.is_interrupted(DECK)


def feed(cell: Cell) -> None:
    """Let the belt run as long as no box is at its stop."""
    if box_at_stop(cell):
        cell.belt().stop()
    else:
        cell.belt().run(BELT_SPEED)


def await_box(cell: Cell) -> bool:
    """Let the belt bring a box to its stop; whether one lies there, and the belt stands."""

    def has_come() -> bool:
        feed(cell)
        return box_at_stop(cell)

    wait_until(cell, has_come, PATIENCE)
    cell.belt().stop()
    return wait_until(cell, lambda: abs(cell.belt().speed()) < STANDING, BRAKING) and box_at_stop(cell)


def wait_until(cell: Cell, condition: Callable[[], bool], seconds: float) -> bool:
    """Let time pass until the condition holds, at most so long; whether it holds."""
    end = cell.time + seconds
    while not condition():
        if cell.time >= end:
            return False
        cell.wait(LOOK)
    return True
