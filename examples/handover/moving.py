"""What the programs of both robots share: moves that give way to people, and a gripper that is asked."""

from __future__ import annotations

from collections.abc import Callable

from station import Station

from mutabot_cell import until
from mutabot_cell.move import Move

FULL, SLOW = 1.0, 0.4
"""Parts of the robots' speed: on their own, and beside a person."""
HUMAN_SPEED, REACTION, STOPPING, RESERVE = 1.6, 0.1, 0.4, 0.2
"""Speed of a person, m/s (ISO 13855); times of the guards and for the robots to stand, s; scanner, m."""
REACH = 0.9
"""Of the robots from the middle between them towards a person, m."""
SLOW_BELOW = REACH + HUMAN_SPEED * (REACTION + STOPPING) + RESERVE
"""Nearer than this a person could be there before a fast robot stands (separation as in ISO/TS 15066), m."""
GRIP_FORCE = 120.0
"""Of both grippers, N: one of them holds a bar at its end."""
OPEN = 0.06
"""The fingers are out of a bar's way, m."""
PATIENCE = 1.5
"""The fingers arrive within, s."""


class Robot:
    """One of the robots, as its program uses it.

    Attributes:
        name: "left" or "right".
        arm, gripper: its own.
    """

    def __init__(self, station: Station, name: str) -> None:
        self.name, self._station = name, station
        self.arm, self.gripper = station.cell.robots[name].arm, station.cell.robots[name].gripper

    async def wait(self, condition: Callable[[], bool], within: float) -> bool:
        """Wait; False if the condition does not hold within so long, s."""
        return await until(self._station.cell, condition, within=within)

    async def go(self, start: Callable[[float], Move]) -> None:
        """Carry out a move to a fixed place, more slowly or after a stop as people come and go.

        Args:
            start: starts the move at a part of the full speed.
        """
        while True:
            await until(self._station.cell, lambda: self.speed() > 0.0)
            if await self._carried_out(start, self.speed()):
                return

    async def _carried_out(self, start: Callable[[float], Move], speed: float) -> bool:
        """Carry out a move unless it must become slower; then it brakes, and False is returned."""
        move = start(speed)
        await until(self._station.cell, lambda: move.done or self.speed() < speed)
        if move.done:
            return True
        move.brake()
        await until(self._station.cell, lambda: move.done)
        return False

    def speed(self) -> float:
        """What part of the full speed is allowed now; 0 if a person has passed the light curtain."""
        guards = self._station.guards
        if not guards.is_clear():
            return 0.0
        return SLOW if guards.distance() < SLOW_BELOW else FULL

    async def close(self) -> bool:
        """Grip; returns whether something is between the fingers."""
        self.gripper.command(1)
        return await self.wait(self.gripper.holding, PATIENCE)

    async def open(self) -> bool:
        """Let go; returns whether the fingers have opened."""
        self.gripper.command(0)
        return await self.wait(lambda: self.gripper.opening() > OPEN, PATIENCE)
