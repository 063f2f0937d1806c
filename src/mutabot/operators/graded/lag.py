"""lag: a command is carried out later, or a reading comes later."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random
from typing import ClassVar

from mutabot.families import GRADED
from mutabot.model import Call, Kind, Middleware, Operation, Path, Pattern, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.model.values.units import Dimension, convert
from mutabot.operators._evidence import TIMING
from mutabot.operators.graded._ladders import ladder_in
from mutabot.operators.graded._shape import graded
from mutabot.operators.operator import Example, Operator, Subject

_GAP = Quantity("result", Path(), Kind.DISTANCE, unit="m")
_HOME = Operation("robot:Arm.home")
_FEEL = Operation("sensor:gap", result=(_GAP,), command=False)


class Lag(Operator):
    """Lets time pass before a command, and after a reading was taken."""

    name = "lag"
    family = GRADED
    has_sizes = True
    summary = (
        "Each command is carried out so much later, while the rest of the world goes on; a reading was taken "
        "so much before the program gets it. Needs a `wait` in the vocabulary, or a middleware."
    )
    where = (
        "every command that is no wait, and every reading, with a `wait` in the vocabulary or a middleware"
    )
    stands_for = f"A busy network or controller: {TIMING}."
    rank = 260
    asks_wait = True
    is_for_oracle = False
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_HOME, variant="200ms", magnitude=200.0, unit="ms"), performed=({},), waited=0.2),
        Example(
            Subject(_FEEL, variant="50ms", magnitude=50.0, unit="ms"),
            replied={"result": 0.3},
            performed=({},),
            waited=0.05,
            note="what was seen then is told now",
        ),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        whole = Subject(operation, pattern)
        named = next((one for one in (*whole.written, *whole.read) if one.ladder_unit is not None), None)
        waits = any(one.kind is Kind.DURATION for one in whole.written)
        if (whole.is_command or whole.read) and not waits:
            return graded(whole, ladder_in(named, Dimension.TIME), "")
        return ()

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        seconds = convert(subject.magnitude or 0.0, subject.unit or "s", "s")

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            if call.is_command:
                await call.wait(seconds)
                return await proceed(call)
            reply = await proceed(call)
            await call.wait(seconds)
            return reply

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        what = "is carried out" if subject.is_command else "comes"
        return f"{what} {subject.magnitude:g} {subject.unit} later"
