"""speed-override: a motion is half as fast, or twice as fast."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.operators._evidence import PARAMETERS
from mutabot.operators.operator import Example, Subject

from ._override import Override

_V = Quantity("speed", Path("speed"), Kind.SPEED, unit="m/s", range=(0.0, 1.0))
_SET = Operation("robot:Arm.set_speed", (_V,))


class SpeedOverride(Override):
    """Halves or doubles a speed or acceleration."""

    name = "speed-override"
    summary = "A speed or acceleration is 50 % or 200 % of what is commanded, within its range."
    rank = 350
    stands_for = f"A wrong parameter: {PARAMETERS}."
    where = "written quantities of kind speed, acceleration or jerk"
    kinds = frozenset({Kind.SPEED, Kind.ACCELERATION, Kind.JERK})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_SET, quantity=_V, variant="x0.5"), {"speed": 0.5}, performed=({"speed": 0.25},)),
        Example(
            Subject(_SET, quantity=_V, variant="x2"),
            {"speed": 0.8},
            performed=({"speed": 1.0},),
            note="its range ends there",
        ),
        Example(
            Subject(_SET, quantity=_V, variant="x2"), {"speed": 1.0}, away="it is at the end of its range"
        ),
    )
