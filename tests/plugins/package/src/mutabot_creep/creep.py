"""creep: a distance sensor is farther off with each reading."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random
from typing import Any, ClassVar

from mutabot.model import Call, Kind, Middleware, Operation, Path, Pattern, Proceed, Quantity, Reply
from mutabot.operators import Example, Operator, Subject
from mutabot.operators.value import is_number

#: what each reading adds to the error, m
STEP = 0.005

_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "m")
_MEASURE = Operation("laser:distance", result=(_GAP,), command=False)


class Creep(Operator):
    """Adds an error that grows by the same step at each reading."""

    name = "creep"
    summary = "A distance is read farther off each time."
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MEASURE, quantity=_GAP),
            replied={"result": 0.5},
            performed=({},),
            received={"result": 0.505},
        ),
        Example(Subject(_MEASURE, quantity=_GAP), replied={"result": None}, away="nothing was measured"),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        whole = Subject(operation, pattern)
        distances = [quantity for quantity in whole.read if quantity.kind is Kind.DISTANCE]
        return [Subject(operation, pattern, quantity) for quantity in distances]

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        quantity = subject.quantity
        assert quantity is not None
        step = quantity.from_unit(STEP, "m")
        error = 0.0

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            nonlocal error
            reply = await proceed(call)
            value = reply.values.get(quantity.name)
            if not is_number(value):
                return reply.as_is("there is no number to shift")
            error += step
            return reply.with_value(quantity, value + error)

        return mutated

    def describe(self, subject: Subject, before: Any, after: Any) -> str:
        assert subject.quantity is not None
        return f"reads {subject.quantity.text(before)} and creeps"
