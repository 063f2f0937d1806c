"""spike: a reading jumps now and then."""

from __future__ import annotations

from random import Random
from typing import Any, ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._draws import Draws
from mutabot.operators._evidence import SENSORS
from mutabot.operators.catalogue._shape import Away, ValueFault, like
from mutabot.operators.operator import Example, Subject, map_numbers
from mutabot.operators.robot._values import label, quantity_of

_SHARES = {"10%": 0.1}
_TIMES = 10.0
_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "m")
_MEASURE = Operation("laser:distance", result=(_GAP,), command=False)
_NEAR = Quantity("result", Path(), Kind.DISTANCE, None, "m", range=(0.0, 2.0))
_LOOK = Operation("laser:near", result=(_NEAR,), command=False)
#: calls of the examples that chance spares before the first spike
_SPARED = ({"result": 0.2},)


class Spike(ValueFault):
    """Gives a value far off, by chance."""

    name = "spike"
    summary = (
        "One reading in ten, by chance, jumps: to the end of its range that is farther off, or to ten"
        " times its value where it has none."
    )
    rank = 343
    remembers = True
    copies = False
    stands_for = f"A sensor that drops out or is misread: {SENSORS}."
    where = "read numbers on a scale, but for orientations as a whole"
    of_written = False
    variants = tuple(_SHARES)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MEASURE, quantity=_GAP, variant="10%"),
            replied={"result": 0.2},
            earlier=_SPARED,
            performed=({},),
            received={"result": 2.0},
        ),
        Example(
            Subject(_LOOK, quantity=_NEAR, variant="10%"),
            replied={"result": 0.2},
            earlier=_SPARED,
            performed=({},),
            received={"result": 2.0},
            note="the far end of its range",
        ),
        Example(Subject(_MEASURE, quantity=_GAP, variant="10%"), replied={"result": 0.2}, away="nine of ten"),
    )

    def is_chance(self, subject: Subject) -> bool:
        return True

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.is_measured and not quantity.is_whole

    def memory(self, random: Random) -> Draws:
        return Draws(random)

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        if memory.next().random() >= _SHARES[subject.variant]:
            raise Away("chance spares it")
        limits = quantity_of(subject).range
        if limits is None:
            return map_numbers(value, lambda number: like(number, _TIMES * number))
        return map_numbers(value, lambda number: like(number, max(limits, key=lambda end: abs(end - number))))

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        jump = "the far end of its range" if quantity.range is not None else f"{_TIMES:g} times as much"
        return f"reads {label(quantity)} {quantity.text(before)}, now and then {jump}"
