"""What must hold at every moment, for all boxes at once. Lengths in m, world frame; speeds in m/s."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from layout import BASE_HEIGHT, BELT_TOP, DECK_TOP, SIZE
from pattern import LAYERS

from mutabot_cell import Cell

Array = np.ndarray[Any, np.dtype[np.float64]]
Flags = np.ndarray[Any, np.dtype[np.bool_]]

BELT_EDGE, BELT_END = 0.35, 0.06
"""The belt lies beyond the one (x) and ends at the other (y)."""
HELD_WITHIN = 0.014
"""The cup holds the box whose top is no further away than this; its plunger gives way by 15 mm."""
LARGEST_TILT = 2.0
"""Degrees. A joint move between two poses that both look down leans over by 1.4° on its way."""
TOUCHED = 0.002
"""What stands on the pallet stays within this: the next box comes as near as 3 mm."""
NEAR, SIDEWAYS = 0.01, 0.05
"""Nearer to what it will stand on than this, a box moves sideways no faster than this."""
SAFE = 0.1
"""While the cup is lower than this above a box at the belt's stop, the belt does not run."""
HOLDING_VACUUM = 50e3
"""A box hangs only with this vacuum, Pa: the cup's switch reports from 55 to 54 kPa."""
PLUNGER = 0.012
"""Its stroke is 0.015."""
LOW = 0.003
"""Deeper a box does not fall when it is let go."""
AT_STOP = 0.01
"""As near to its place at the stop (y = 0) a box lies there."""
RUBBED = 0.08
"""The belt runs no further under a box that its stop holds. It runs 0.047 as the program means it: the box is
at its place within 0.01, the light barrier tells late, and the belt brakes."""


def watch_boxes(cell: Cell, names: Sequence[str]) -> None:
    """For boxes that are picked and set down: gently, upright, with enough vacuum."""
    if not names:
        return
    boxes = Boxes(cell, names)
    cell.always(lambda: bool(boxes.are_upright().all()), "boxes stay upright")
    cell.always(lambda: bool(boxes.are_supported().all()), "no box is dropped")
    cell.always(lambda: bool(boxes.are_gentle().all()), "no box is dragged over another")
    cell.always(lambda: boxes.rubbed() < RUBBED, "the belt does not rub under a box at its stop")


def watch_stack(cell: Cell, names: Sequence[str]) -> None:
    """For what stands there from the beginning: nothing moves it."""
    if not names:
        return
    boxes = Boxes(cell, names)
    before = boxes.places()
    cell.always(lambda: bool((np.abs(boxes.places() - before) < TOUCHED).all()), "the rest is not touched")


def watch_belt(cell: Cell) -> None:
    """For every test case: the belt stands while the cup is at its stop."""
    cell.always(
        lambda: not is_at_stop(cell) or abs(cell.truth.belt_speed()) < 0.001,
        "the belt stands while the cup is at its stop",
    )


def watch_cup(cell: Cell) -> None:
    """For every test case: the cup is pressed on nothing as deep as its plunger gives way."""
    plunger = cell.simulation.data.joint("plunger").qpos
    cell.always(lambda: float(plunger[0]) < PLUNGER, "the cup is not pressed too hard")


def is_at_stop(cell: Cell) -> bool:
    """Whether the cup is near a box that lies at the stop."""
    tool = cell.truth.tool_position()
    low = tool.z + BASE_HEIGHT - BELT_TOP - SIZE[2] < SAFE
    return low and math.hypot(tool.x - 0.5, tool.y) < 0.1


class Boxes:
    """Several boxes, from tick to tick."""

    def __init__(self, cell: Cell, names: Sequence[str]) -> None:
        model, self._cell = cell.simulation.model, cell
        self._bodies = [model.body(name).id for name in names]
        self._heights: Array = np.array([2 * model.geom(name).size[2] for name in names])
        self._time, self._before = cell.time, self.places()
        self._travel, self._rubbed = cell.truth.belt_position(), 0.0

    def places(self) -> Array:
        """Of the middles of their bottom faces, shape (boxes, 3); they stand upright."""
        found: Array = self._cell.simulation.data.xpos[self._bodies]
        found[:, 2] -= self._heights / 2
        return found

    def are_upright(self) -> Flags:
        """Of each, shape (boxes,)."""
        upward = self._cell.simulation.data.xmat[self._bodies, 8]
        found: Flags = upward > math.cos(math.radians(LARGEST_TILT))
        return found

    def are_supported(self) -> Flags:
        """Of each, whether it stands on something, or hangs on the cup with enough vacuum."""
        stands = self._clearances(self.places()) < LOW
        hangs = self._hang() & (self._cell.truth.vacuum() > HOLDING_VACUUM)
        found: Flags = stands | hangs
        return found

    def are_gentle(self) -> Flags:
        """Of each, whether it is high, moves slowly sideways, or rides on the belt."""
        places = self.places()
        before, self._before = self._before, places
        passed, self._time = self._cell.time - self._time, self._cell.time
        speeds = np.hypot(*(places - before)[:, :2].T) / (passed or math.inf)
        found: Flags = (speeds < SIDEWAYS) | (self._clearances(places) > NEAR) | _on_belt(places)
        return found

    def rubbed(self) -> float:
        """How far the belt has run since one of them lies at its stop."""
        places, travel = self.places(), self._cell.truth.belt_position()
        lies = (np.abs(places[:, 1]) < AT_STOP) & _on_belt(places) & (self._clearances(places) < LOW)
        self._rubbed = self._rubbed + travel - self._travel if lies.any() else 0.0
        self._travel = travel
        return self._rubbed

    def _hang(self) -> Flags:
        tool, places = self._cell.truth.tool_position(), self.places()
        gaps = tool.z + BASE_HEIGHT - places[:, 2] - self._heights
        beside = np.hypot(places[:, 0] - tool.x, places[:, 1] - tool.y)
        found: Flags = (np.abs(gaps) < HELD_WITHIN) & (beside < HELD_WITHIN)
        return found

    def _clearances(self, places: Array) -> Array:
        """Above the belt, or above the height at which boxes of a layer below stand."""
        height = SIZE[2]
        over_deck = places[:, 2] - DECK_TOP
        layers = np.clip((over_deck + LOW) // height, 0, LAYERS - 1)
        found: Array = np.where(_on_belt(places), places[:, 2] - BELT_TOP, over_deck - layers * height)
        return found


def _on_belt(places: Array) -> Flags:
    found: Flags = (places[:, 0] > BELT_EDGE) & (places[:, 1] < BELT_END)
    return found
