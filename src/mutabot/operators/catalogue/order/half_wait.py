"""half-wait: a wait is half as long."""

from __future__ import annotations

from typing import Any, ClassVar

from mutabot.model import Kind, Operation, Path, Quantity
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import TIMING
from mutabot.operators.catalogue._shape import ValueFault, like
from mutabot.operators.operator import Example, Subject, map_numbers

_SECONDS = Quantity("seconds", Path("seconds"), Kind.DURATION, unit="s", range=(0.0, 60.0))
_WAIT = Operation("cell:wait", (_SECONDS,))


class HalfWait(ValueFault):
    """Shortens a duration that is written."""

    name = "half-wait"
    summary = "A wait is half as long: the next command comes before what was waited for is over."
    rank = 332
    stands_for = f"Something too early, too late or in the wrong order: {TIMING}."
    where = "written quantities of kind duration"
    of_read = False
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_WAIT, quantity=_SECONDS), {"seconds": 0.8}, performed=({"seconds": 0.4},)),
        Example(Subject(_WAIT, quantity=_SECONDS), {"seconds": 0.0}, away="there is nothing to shorten"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind is Kind.DURATION

    def change(self, subject: Subject, value: Value, memory: Any) -> Value | None:
        return map_numbers(value, lambda number: like(number, number / 2.0))
