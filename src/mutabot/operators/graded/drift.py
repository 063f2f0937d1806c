"""drift: a reading moves away with time."""

from __future__ import annotations

from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.operators._evidence import SENSORS
from mutabot.operators.graded._ladders import Ladder, per_second
from mutabot.operators.graded._shape import GradedOperator, Passed
from mutabot.operators.operator import Example, Subject

_GAP = Quantity("result", Path(), Kind.DISTANCE, unit="m")
_FEEL = Operation("sensor:gap", result=(_GAP,), command=False)


class Drift(GradedOperator):
    """Adds so much per second of simulated time since the test began."""

    name = "drift"
    summary = "A reading drifts: it is off by δ for every second of simulated time since the test began."
    where = "every number that is read, with a clock in the vocabulary"
    stands_for = f"A sensor that warms up, or odometry that is summed: {SENSORS}."
    rank = 230
    asks_time = True
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_FEEL, None, _GAP, "+2mm/s", 2.0, "mm/s", "+"),
            replied={"result": 0.3},
            performed=({},),
            received={"result": 0.32},
            time=10.0,
            note="2 mm per second: after 10 s it reads 20 mm too much",
        ),
        Example(
            Subject(_FEEL, None, _GAP, "-2mm/s", 2.0, "mm/s", "-"),
            replied={"result": 0.3},
            away="no time has passed yet",
        ),
    )

    def ladder(self, quantity: Quantity, *, written: bool) -> Ladder | None:
        return None if written else per_second(quantity)

    def number(self, size: float, value: float, passed: Passed) -> float:
        return value + size * passed.time()

    def unit_of(self, subject: Subject) -> str | None:
        return (subject.unit or "").removesuffix("/s") or None
