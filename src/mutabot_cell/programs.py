"""Runs programs of several robots on one clock: while one waits, the others continue."""

from __future__ import annotations

import math
from collections.abc import Awaitable, Callable, Coroutine, Generator, Mapping
from random import Random
from typing import TypeVar

from .cell import Cell
from .errors import BadArgument, ProgramsStuck

Result = TypeVar("Result")


class _Tick(Awaitable[None]):
    """An awaitable that ends at the next control tick."""

    def __await__(self) -> Generator[None]:
        yield


async def until(cell: Cell, condition: Callable[[], object], *, within: float = math.inf) -> bool:
    """Wait in a program of `run_together` until a condition holds, checked once per control tick.

    Args:
        cell: whose time passes.
        condition: gives something true as soon as it holds.
        within: wait at most so long, simulated s.

    Returns:
        Whether it holds; False if the time is over.
    """
    end = cell.time + within - 1e-9
    while not condition():
        if cell.time >= end:
            return False
        await _Tick()
    return True


def run_together(
    cell: Cell, programs: Mapping[str, Coroutine[object, object, Result]], *, within: float, seed: int = 0
) -> dict[str, Result]:
    """Run a program for each robot until all have ended, in turns at every control tick.

        async def take(cell): ...
            move = cell.robots["right"].arm.start_home()
            await until(cell, lambda: move.done)

        run_together(cell, {"left": give(cell), "right": take(cell)}, within=60)

    A program must not call what lets time pass, such as a move that blocks: meanwhile no other one would run.

    Args:
        cell: whose clock they share.
        programs: by their names, each a call of a function that is `async def`.
        within: all must have ended after so long, simulated s.
        seed: the order within each tick is drawn from it, so that what depends on the order can be found, and
            found again.

    Returns:
        What each program returned.

    Raises:
        BadArgument: no program, or a time that is not positive.
        ProgramsStuck: they had not ended in time.
        ProtectiveStop: of any arm; like every other exception it ends all programs.
    """
    if not programs or not within > 0.0:
        raise BadArgument(f"Expected programs and a time but got programs={programs!r}, within={within!r}")
    draw, end = Random(f"turns {seed}"), cell.time + within
    waiting, results = dict(programs), dict[str, Result]()
    try:
        while True:
            for name in draw.sample(sorted(waiting), len(waiting)):
                try:
                    waiting[name].send(None)
                except StopIteration as ended:
                    results[name] = ended.value
                    del waiting[name]
            if not waiting:
                return results
            if cell.time > end - 1e-9:
                raise ProgramsStuck(time=cell.time, names=sorted(waiting))
            cell.simulation.tick()
    finally:
        for program in programs.values():
            program.close()
