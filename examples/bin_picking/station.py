"""What stands around the robot: a bin full of parts, three trays, a stand, a depth camera."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from random import Random

from mutabot_cell import Box, Cell, DepthCamera, Fixture, Mesh, Scene, gen3, suction_cup
from mutabot_cell.parts import Part, Vector3

BASE_HEIGHT, TABLE_TOP = 0.9, 1.0
"""Of the robot's base and of the table above the floor, m."""
BIN, BIN_SIZE, BIN_DEPTH, SHEET = (0.43, 0.0), (0.26, 0.36), 0.07, 0.01
"""Where the middle of the bin is, its inner size and its depth, and the thickness of its sheets, m."""
BOTTOM, RIM = TABLE_TOP + SHEET, TABLE_TOP + BIN_DEPTH
"""Heights of its bottom and its rim above the floor, m."""
TRAYS = {"plate": (0.45, -0.36), "cube": (0.21, -0.36), "nut": (0.21, 0.36)}
"""The middle of the tray of each shape, m."""
TRAY_SIZE, TRAY_TOP = (0.22, 0.24), 0.01
"""Of a tray, and its height above the table, m."""
STAND, STAND_SIZE, STAND_TOP = (0.43, 0.30), 0.12, 0.03
"""The plate on which a part is put down to look at it alone: its middle, its edge and its height, m."""
CAMERA_HEIGHT = 0.7
"""Above the table, m."""
CUP, CUP_LENGTH = 0.014, 0.16
"""Diameter and length of the suction cup, m."""
PLATE, CUBE, NUT = (0.060, 0.034, 0.024), 0.044, (0.022, 0.028)
"""Edges of a plate and of a cube; edge and thickness of a nut, m."""
MASSES = {"plate": 0.05, "cube": 0.08, "nut": 0.04}
FALL = (0.085, 0.045, 0.062)
"""How far apart parts begin to fall, how high above the table, and how far above each other, m."""
SETTLING = 2.5
"""So long the parts fall until they lie, s."""


@dataclass(frozen=True)
class Station:
    """The cell with its parts.

    Attributes:
        names: of the parts, such as "plate 0".
    """

    cell: Cell
    names: tuple[str, ...]

    def shape(self, name: str) -> str:
        """The shape of a part."""
        return name.split(maxsplit=1)[0]


def build(
    new_cell: Callable[..., Cell], seed: int, *, parts: int = 6, shapes: tuple[str, ...] = tuple(MASSES)
) -> Station:
    """A station whose bin has been filled: parts in random poses have fallen into it, as drawn from the seed.

    Args:
        new_cell: makes the cell.
        parts: how many, at most 18.
        shapes: of the parts, by turns.
    """
    draw = Random(f"parts {seed}")
    loose = tuple(part(draw, number, shapes[number % len(shapes)]) for number in range(parts))
    scene = Scene(
        fixtures=(
            Fixture("table", (0.9, 1.1, 0.05), (0.5, 0.0, TABLE_TOP - 0.025)),
            *bin_sheets(),
            *(flat(f"{name} tray", *place, *TRAY_SIZE, TRAY_TOP) for name, place in TRAYS.items()),
            flat("stand", *STAND, STAND_SIZE, STAND_SIZE, STAND_TOP),
        ),
        marks=(),
        parts=loose,
        depth_cameras=(DepthCamera("bin", (*BIN, TABLE_TOP + CAMERA_HEIGHT), (180.0, 0.0, 90.0)),),
    )
    cell = new_cell(seed, robot=gen3().with_tool(suction_cup(CUP, length=CUP_LENGTH)), scene=scene)
    cell.wait(SETTLING)
    return Station(cell, tuple(item.name for item in loose))


def part(draw: Random, number: int, shape: str) -> Part:
    """A part in the air above the bin."""
    layer, place = divmod(number, 6)
    row, column = divmod(place, 3)
    x, y = BIN[0] + (row - 0.5) * FALL[0], BIN[1] + (column - 1) * FALL[0]
    drift, height = draw.uniform(-0.01, 0.01), TABLE_TOP + FALL[1] + FALL[2] * layer
    position = (x + drift, y + draw.uniform(-0.01, 0.01), height)
    angles = (draw.uniform(-40, 40), draw.uniform(-40, 40), draw.uniform(0, 360))
    name, mass = f"{shape} {number}", MASSES[shape]
    if shape == "nut":
        return Mesh(
            name=name, position=position, angles=angles, mass=mass, jitter=0.0, colour="red", vertices=nut()
        )
    size = PLATE if shape == "plate" else (CUBE, CUBE, CUBE)
    return Box(name=name, position=position, angles=angles, mass=mass, jitter=0.0, colour="blue", size=size)


def nut() -> tuple[Vector3, ...]:
    """The corners of a nut, a prism with six sides."""
    edge, thickness = NUT
    turns = [math.radians(60 * corner) for corner in range(6)]
    return tuple(
        (edge * math.cos(turn), edge * math.sin(turn), side * thickness / 2)
        for turn in turns
        for side in (-1, 1)
    )


def bin_sheets() -> tuple[Fixture, ...]:
    """The bottom and the four walls of the bin."""
    (x, y), (along, across), height = BIN, BIN_SIZE, TABLE_TOP + BIN_DEPTH / 2
    beside = (along + SHEET) / 2, (across + SHEET) / 2
    return (
        Fixture("bin bottom", (along, across, SHEET), (x, y, TABLE_TOP + SHEET / 2)),
        Fixture("bin -x", (SHEET, across + 2 * SHEET, BIN_DEPTH), (x - beside[0], y, height)),
        Fixture("bin +x", (SHEET, across + 2 * SHEET, BIN_DEPTH), (x + beside[0], y, height)),
        Fixture("bin -y", (along, SHEET, BIN_DEPTH), (x, y - beside[1], height)),
        Fixture("bin +y", (along, SHEET, BIN_DEPTH), (x, y + beside[1], height)),
    )


def flat(name: str, x: float, y: float, along: float, across: float, top: float) -> Fixture:
    """A plate on the table."""
    return Fixture(name, (along, across, top), (x, y, TABLE_TOP + top / 2))
