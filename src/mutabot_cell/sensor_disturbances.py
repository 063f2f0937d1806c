"""Disturbances of a cell's sensors, named in this package's `world.toml`. See `disturbances`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import cycle
from random import Random

from .cell import Cell
from .disturbances import Changed, robots

_AXES = "xyz"
#: readings of one look of a sensor: the camera gives x, y and z
_PER_LOOK = {"box position": 3}


def bias(
    cell: Cell, change: Changed, *, names: str, random: Random, sensor: str, axis: str = "", unit: float = 1.0
) -> None:
    """Add a constant error to a sensor, or a fraction of its reading.

    Args:
        names: of robots.
        sensor: as `models.noise` names it: "box position", "distance", "opening", "joint angle" …
        axis: of positions; all without.
        unit: how many of the SI's unit the sensor's own is.
    """
    number = _AXES.index(axis) if axis else None

    def read(count: int, value: float) -> float:
        return change(value * unit) / unit if number in (None, count) else value

    _disturb(cell, names, sensor, read)


def drift(
    cell: Cell, change: Changed, *, names: str, random: Random, sensor: str, axis: str = "", unit: float = 1.0
) -> None:
    """Add an error that grows by this each second; otherwise as `bias`."""
    number, begin = _AXES.index(axis) if axis else None, cell.time

    def read(count: int, value: float) -> float:
        return value + change(0.0) / unit * (cell.time - begin) if number in (None, count) else value

    _disturb(cell, names, sensor, read)


def noise(cell: Cell, change: Changed, *, names: str, random: Random, sensor: str, unit: float = 1.0) -> None:
    """Add normal noise of this standard deviation to the sensor's own."""
    _disturb(cell, names, sensor, lambda count, value: value + random.gauss(0.0, change(0.0) / unit))


def dropout(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Let the camera see no part in a share of pictures: reading it raises `SensorError`."""
    for system in robots(cell, names):
        system.sensors.hidden.append(lambda *_: random.random() < change(0.0))


def outage(cell: Cell, change: Changed, *, names: str, random: Random, begin: float = 0.0) -> None:
    """Let the camera see no part for a time, s, from a simulated time on."""
    for system in robots(cell, names):
        system.sensors.hidden.append(lambda *_: begin <= cell.time < begin + change(0.0))


def occlusion(
    cell: Cell, change: Changed, *, names: str, random: Random, part: str = "", share: float = 0.5
) -> None:
    """Put a ball with this radius, m, into the camera's line of sight to a part.

    Args:
        names: of robots.
        part: the first one without.
        share: where it stands, from the camera (0) to the part (1).
    """
    parts = [scene_part.name for scene_part in cell.simulation.scene.parts]
    if not parts:
        raise LookupError("there is no part")
    target = cell.simulation.data.xpos[cell.simulation.id_of("body", part or parts[0])]
    for system in robots(cell, names):
        camera = system.sensors.camera
        system.sensors.balls.append((camera + share * (target - camera), change(0.0)))


def latency(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change the age of a camera picture when it can first be read, s, in whole control ticks."""
    cell.simulation.set_camera(latency=change(cell.simulation.camera_latency))


def interval(cell: Cell, change: Changed, *, names: str, random: Random) -> None:
    """Change the time between pictures of the camera, s; a multiple of the camera's own."""
    cell.simulation.set_camera(interval=change(cell.simulation.camera_interval))


def _disturb(cell: Cell, names: str, sensor: str, read: Callable[[int, float], float]) -> None:
    """Change a sensor's readings; `read` gets the index of the value within a reading."""
    for system in robots(cell, names):
        numbers = cycle(range(_PER_LOOK.get(sensor, 1)))
        system.noise.errors[sensor] = partial(_read_next, numbers, read)


def _read_next(numbers: Iterator[int], read: Callable[[int, float], float], value: float) -> float:
    return read(next(numbers), value)
