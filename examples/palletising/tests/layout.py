"""The cell around the robot, as built: m, world frame."""

from __future__ import annotations

from dataclasses import replace

from pattern import Slot, slots

from mutabot_cell import Belt, Box, Fixture, LightBarrier, Scene

BASE_HEIGHT = 0.9
BELT_TOP, DECK_TOP = 0.9, 0.7
SIZE = (0.12, 0.08, 0.08)
PITCH = 0.2
"""From box to box on the belt."""
PALLET_AT = (0.0, 0.48)
_STOP = 0.04
"""Where the stop's face stands (y): a box at it has its middle at 0."""
_BELT_LENGTH = 6.0

BELT = Fixture(
    "conveyor",
    (0.3, _BELT_LENGTH, 0.1),
    (0.5, 0.06 - _BELT_LENGTH / 2, BELT_TOP - 0.05),
    (0.27, 0.29, 0.31, 1.0),
    friction=0.6,
    belt=Belt(),
)
STOP = Fixture("stop", (0.3, 0.02, 0.05), (0.5, _STOP + 0.01, BELT_TOP + 0.025))
STAND = Fixture("stand", (0.5, 0.4, 0.6), (*PALLET_AT, 0.3))
PALLET = Fixture("pallet", (0.4, 0.3, 0.1), (*PALLET_AT, DECK_TOP - 0.05), (0.72, 0.60, 0.44, 1.0))
BARRIERS = (
    LightBarrier(
        "box at the stop", (0.3, _STOP - 0.005, BELT_TOP + 0.04), (0.7, _STOP - 0.005, BELT_TOP + 0.04)
    ),
    LightBarrier("pallet", (-0.5, 0.51, DECK_TOP - 0.05), (0.5, 0.51, DECK_TOP - 0.05)),
    LightBarrier("on the deck", (-0.5, 0.51, DECK_TOP + 0.01), (0.5, 0.51, DECK_TOP + 0.01)),
)
BOX = Box(mass=0.8, size=SIZE, rgba=(0.76, 0.60, 0.42, 1.0))


def on_belt(count: int, first: int = 1) -> list[Box]:
    """Boxes one behind the other, the foremost 0.2 m before its place at the stop."""
    return [
        replace(BOX, name=f"box {first + n}", position=(0.5, -PITCH * (n + 1), BELT_TOP))
        for n in range(count)
    ]


def scene(*parts: Box, pallet: bool = True) -> Scene:
    """Everything, with these boxes; the camera looks down on the pallet."""
    fixtures = (BELT, STOP, STAND, PALLET) if pallet else (BELT, STOP, STAND)
    return Scene(fixtures, (), parts, BARRIERS, camera=(0.9, 1.2, 2.6))


def at_slot(slot: Slot) -> tuple[float, float, float]:
    """Where a box lies that stands in its slot."""
    return (PALLET_AT[0] + slot.x, PALLET_AT[1] + slot.y, DECK_TOP + slot.z)


def on_pallet(count: int) -> list[Box]:
    """The first boxes of the pattern, each where it belongs."""
    return [
        replace(
            BOX, name=f"placed {n}", position=at_slot(slot), angles=(0.0, 0.0, 90.0 if slot.across else 0.0)
        )
        for n, slot in enumerate(slots()[:count], start=1)
    ]
