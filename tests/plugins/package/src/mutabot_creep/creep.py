"""creep: a distance sensor is farther off with each reading."""

from __future__ import annotations

from typing import Any

from mutabot.api.faults import Context, Example, Subject, ValueOperator
from mutabot.api.values import Kind, Operation

#: what each reading adds to the error, m
STEP = 0.005

_MEASURE = Operation.reading("laser:distance", Kind.DISTANCE, unit="m")


class Creep(ValueOperator):
    """Adds an error that grows by the same step at each reading."""

    name = "creep"
    summary = "A distance is read farther off each time."
    kinds = frozenset({Kind.DISTANCE})
    of_written = False
    examples = (
        Example.changed(_MEASURE, 0.5, 0.505),
        Example.unchanged(_MEASURE, None, "nothing was measured"),
    )

    def change(self, value: Any, context: Context) -> Any | None:
        if not context.quantity.is_scalar(value):
            return None
        return value + context.number * context.quantity.from_unit(STEP, "m")

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        return f"reads {subject.required_quantity.text(before)} and creeps"
