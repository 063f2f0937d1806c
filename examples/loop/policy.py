"""Push the puck to its mark: one decision for every step, from what was seen after the last."""

from __future__ import annotations

import math

from pushing import FINGER, GOAL, PUCK, REACH, Pushing, Seen

STEPS = 400
"""After so many the policy gives up."""
THERE = 0.004
"""The puck is where it belongs, m: eight standard deviations of the camera."""
BEHIND = PUCK + FINGER + 0.01
"""From the middle of the puck to where the finger begins to push, m."""
ALIGNED = 0.006
"""How far the finger may be off the line through puck and mark while it pushes, m."""


def run(table: Pushing) -> bool:
    """Push until the puck is there; False if it takes too long. The finger ends clear of the puck."""
    seen = table.look()
    for _ in range(STEPS):
        if math.dist(seen.puck, GOAL) < THERE:
            return withdraw(table, seen)
        seen = table.step(action(seen))
    return False


def action(seen: Seen) -> tuple[float, float]:
    """The next step of the finger (x, y), m."""
    (px, py), (fx, fy) = seen.puck, seen.finger
    way = math.dist(seen.puck, GOAL)
    ux, uy = (GOAL[0] - px) / way, (GOAL[1] - py) / way
    along = (px - fx) * ux + (py - fy) * uy
    aside = (px - fx) * uy - (py - fy) * ux
    if along > PUCK and abs(aside) < ALIGNED:
        push = min(REACH, way)
        return push * ux + 0.2 * aside * uy, push * uy - 0.2 * aside * ux
    if along < PUCK and abs(aside) < BEHIND:  # on the wrong side: around the puck, not through it
        side = BEHIND * 1.2 if aside > 0 else -BEHIND * 1.2
        return towards(seen.finger, (px - side * uy - BEHIND * ux, py + side * ux - BEHIND * uy))
    return towards(seen.finger, (px - BEHIND * ux, py - BEHIND * uy))


def towards(here: tuple[float, float], there: tuple[float, float]) -> tuple[float, float]:
    """A step that goes straight there, as long as one may be."""
    way = math.dist(here, there)
    share = min(1.0, REACH / way) if way else 0.0
    return (there[0] - here[0]) * share, (there[1] - here[1]) * share


def withdraw(table: Pushing, seen: Seen) -> bool:
    """Take the finger away from the puck."""
    for _ in range(15):
        away = towards(seen.puck, seen.finger)
        seen = table.step(away)
    return True
