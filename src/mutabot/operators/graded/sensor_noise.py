"""sensor-noise: a reading is disturbed, by more and more."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.operators._draws import Draws
from mutabot.operators._evidence import SENSORS
from mutabot.operators.graded._ladders import Ladder, own_ladder
from mutabot.operators.graded._shape import GradedOperator, Passed
from mutabot.operators.operator import Example, Subject

_X = Quantity(".x", Path.parse(".x", rooted=False), Kind.POSITION, "x", "m", "world")
_LOCATE = Operation("camera:locate", result=(_X,), command=False)


class SensorNoise(GradedOperator):
    """Adds Gaussian noise to each reading: the same deviates at every magnitude, so much larger."""

    name = "sensor-noise"
    summary = (
        "Each reading is off by Gaussian noise of standard deviation σ. The draws of a round are the same at "
        "every σ: a larger one is the same noise, only larger."
    )
    where = "every number that is read"
    stands_for = f"A worse sensor than the program was written for: {SENSORS}."
    rank = 220
    draws = True
    directions = ("",)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_LOCATE, None, _X, "10mm", 10.0, "mm"),
            replied={".x": 0.55},
            performed=({},),
            # the draw for the first call of the generator that the examples are run with
            received={".x": 0.55 + 0.01 * Draws(Random(1)).next().gauss(0.0, 1.0)},
            note="σ = 10 mm",
        ),
        Example(
            Subject(_LOCATE, None, _X, "10mm", 10.0, "mm"),
            replied={".x": None},
            away="there is no number to disturb",
        ),
    )

    def ladder(self, quantity: Quantity, *, written: bool) -> Ladder | None:
        return None if written else own_ladder(quantity)

    def number(self, size: float, value: float, passed: Passed) -> float:
        return value + size * passed.random.gauss(0.0, 1.0)

    def fault(self, subject: Subject) -> str:
        return f"+ noise, σ = {subject.magnitude:g}{f' {subject.unit}' if subject.unit else ''}"
