"""Disturbances of a cell: what `world.toml` of this package names.

Each is a function of the cell and of the change, which says what becomes of a number in SI units; and, by
name, of `names` (which of the cell's things are meant), `random`, and options. Each raises LookupError if the
cell has nothing of the name. They change the cell at once, in the middle of a run too.
"""

from __future__ import annotations

from collections.abc import Callable
from fnmatch import fnmatchcase
from random import Random
from typing import TypeAlias

import mujoco

from .cell import Cell

NumberChange: TypeAlias = Callable[[float], float]


def part_mass(cell: Cell, change: NumberChange, *, names: str, random: Random) -> None:
    """Mass of parts, kg, with their inertia: they are as large as before."""
    model = cell.simulation.model
    for body in _parts(cell, names):
        factor = max(change(float(model.body_mass[body])), 1e-6) / float(model.body_mass[body])
        model.body_mass[body] *= factor
        model.body_inertia[body] *= factor
    _settle(cell)


def _parts(cell: Cell, names: str) -> list[int]:
    """The bodies of the parts that are meant."""
    found = [part.name for part in cell.simulation.scene.parts]
    return [int(cell.simulation.model.body(name).id) for name in _named(found, names, "part")]


def _named(found: list[str], names: str, what: str) -> list[str]:
    meant = [name for name in found if fnmatchcase(name, names)]
    if not meant:
        raise LookupError(f"no {what} is named {names!r}; there are: {', '.join(found) or 'none'}")
    return meant


def _settle(cell: Cell) -> None:
    """Let constants of the model follow a change. With the cell's own state, the joints would go to zero."""
    model = cell.simulation.model
    mujoco.mj_setConst(model, mujoco.MjData(model))
    mujoco.mj_forward(model, cell.simulation.data)
