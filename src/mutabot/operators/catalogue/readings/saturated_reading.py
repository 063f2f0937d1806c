"""saturated-reading: a sensor ends before its range does."""

from __future__ import annotations

from random import Random
from typing import Any, ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import SENSORS
from mutabot.operators.catalogue._shape import ValueFault, middle_of, within
from mutabot.operators.operator import Example, Subject, is_number, map_numbers
from mutabot.operators.robot._values import quantity_of

_SHARE = 0.8
_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "m")
_MEASURE = Operation("laser:distance", result=(_GAP,), command=False)
_NEAR = Quantity("result", Path(), Kind.DISTANCE, None, "m", range=(0.0, 2.0))
_LOOK = Operation("laser:near", result=(_NEAR,), command=False)


class SaturatedReading(ValueFault):
    """Limits a reading to less than it can be."""

    name = "saturated-reading"
    summary = (
        "A sensor saturates: its reading is limited to the middle 80 % of its range, or without a range"
        " to 80 % of the size of the first one at its place in the test."
    )
    rank = 344
    remembers = True
    copies = False
    stands_for = f"A sensor that drops out or is misread: {SENSORS}."
    where = "read numbers on a scale, but for orientations as a whole"
    of_written = False
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_LOOK, quantity=_NEAR),
            replied={"result": 1.9},
            performed=({},),
            received={"result": 1.8},
        ),
        Example(
            Subject(_MEASURE, quantity=_GAP),
            replied={"result": -0.5},
            earlier=({"result": 0.5},),
            performed=({},),
            received={"result": -0.4},
        ),
        Example(Subject(_LOOK, quantity=_NEAR), replied={"result": 1.0}, away="it is in the middle"),
        Example(
            Subject(_MEASURE, quantity=_GAP),
            replied={"result": 0.1},
            earlier=({"result": 0.5},),
            away="it is less than 80 % of the first",
        ),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.is_measured and not quantity.is_whole

    def memory(self, random: Random) -> list[float]:
        return []

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        quantity = quantity_of(subject)
        if quantity.range is not None:
            limits = middle_of(quantity, _SHARE)
        elif is_number(value):
            if not memory:
                memory.append(_SHARE * abs(value))
            limits = (-memory[0], memory[0])
        else:
            return None
        return map_numbers(value, lambda number: within(number, limits))
