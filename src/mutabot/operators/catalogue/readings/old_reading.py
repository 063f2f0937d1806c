"""old-reading: a reading is some calls old."""

from __future__ import annotations

from collections import deque
from random import Random
from typing import Any, ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import SENSORS
from mutabot.operators.catalogue._shape import Away, ValueFault, kept
from mutabot.operators.operator import Example, Subject
from mutabot.operators.robot._values import label, quantity_of

_AGES = {"1": 1, "5": 5}
_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "m")
_MEASURE = Operation("laser:distance", result=(_GAP,), command=False)


class OldReading(ValueFault):
    """Gives the value of an earlier call at this place."""

    name = "old-reading"
    summary = "A reading is old: the value of the call before, or of five calls before, at the same place."
    rank = 341
    remembers = True
    copies = False
    stands_for = f"A sensor that drops out or is misread: {SENSORS}."
    where = "read quantities, at places that a test calls more than once"
    of_written = False
    variants = tuple(_AGES)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MEASURE, quantity=_GAP, variant="1"),
            replied={"result": 0.2},
            earlier=({"result": 0.5}, {"result": 0.3}),
            performed=({},),
            received={"result": 0.3},
        ),
        Example(
            Subject(_MEASURE, quantity=_GAP, variant="5"),
            replied={"result": 0.2},
            earlier=({"result": 0.5},),
            away="there is none so old yet",
        ),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return True

    def least_calls(self, subject: Subject) -> int:
        return _AGES[subject.variant] + 1

    def memory(self, random: Random) -> deque[Value]:
        return deque(maxlen=max(_AGES.values()))

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        age = _AGES[subject.variant]
        old = memory[-age] if len(memory) >= age else None
        memory.append(kept(value))
        if old is None:
            raise Away("there is none so old yet")
        return kept(old)

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        calls = "1 call" if subject.variant == "1" else f"{subject.variant} calls"
        return f"reads the {label(quantity_of(subject))} of {calls} ago"
