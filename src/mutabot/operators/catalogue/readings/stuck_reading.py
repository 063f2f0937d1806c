"""stuck-reading: a sensor is stuck at its first reading."""

from __future__ import annotations

from random import Random
from typing import Any, ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import SENSORS
from mutabot.operators.catalogue._shape import Away, ValueFault, kept
from mutabot.operators.operator import Example, Subject
from mutabot.operators.robot._values import label, quantity_of

_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "m")
_MEASURE = Operation("laser:distance", result=(_GAP,), command=False)


class StuckReading(ValueFault):
    """Gives the first value of the test at this place for ever."""

    name = "stuck-reading"
    summary = "A sensor is stuck: from the second call on a place reads what it read first in the test."
    rank = 342
    remembers = True
    copies = False
    stands_for = f"A sensor that drops out or is misread: {SENSORS}."
    where = "read quantities, at places that a test calls more than once"
    of_written = False
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MEASURE, quantity=_GAP),
            replied={"result": 0.2},
            earlier=({"result": 0.5}, {"result": 0.3}),
            performed=({},),
            received={"result": 0.5},
        ),
        Example(Subject(_MEASURE, quantity=_GAP), replied={"result": 0.2}, away="it is the first reading"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return True

    def least_calls(self, subject: Subject) -> int:
        return 2

    def memory(self, random: Random) -> list[Value]:
        return []

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        if not memory:
            memory.append(kept(value))
            raise Away("it is the first reading")
        return kept(memory[0])

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return f"reads the first {label(quantity_of(subject))} again and again"
