"""The line to the robot: commands go out as text, readings come back as text."""

from __future__ import annotations

from cell import Cell, World

_cell: Cell | None = None


def connect(cell: Cell) -> None:
    """Everything sent from now on goes to this cell."""
    global _cell  # noqa: PLW0603  # the program knows one line, as on a real robot
    _cell = cell


def send(text: str) -> None:
    """Send a command, such as ``lift/5``, and wait until the robot has done it.

    Raises Refused if the robot does not take the command, ProtectiveStop if it hits something.
    """
    _connected().execute(text)


def read(name: str) -> str:
    """A reading as text: ``color``, ``height`` in cm, ``heading`` in deg, ``weight/left`` or ``/right`` in g.

    Raises UnknownCommand for any other name.
    """
    return _connected().reading(name)


def world() -> World:
    """What is true in the cell now: for people and tools, not for programs."""
    return _connected().world


def _connected() -> Cell:
    if _cell is None:
        raise RuntimeError("no cell is connected")
    return _cell
