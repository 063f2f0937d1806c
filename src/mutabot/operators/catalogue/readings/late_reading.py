"""late-reading: an answer comes late."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import ClassVar

from mutabot.families import CATALOGUE
from mutabot.model import Call, Kind, Middleware, Operation, Path, Pattern, Proceed, Quantity, Reply
from mutabot.model.named import COMING
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import TIMING
from mutabot.operators.operator import Example, Operator, Subject

#: seconds: a camera whose picture has to be worked out
_LATE = 0.5
_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "m")
_MEASURE = Operation("laser:distance", result=(_GAP,), command=False)


class LateReading(Operator):
    """Lets time pass between a reading and the program."""

    name = "late-reading"
    family = CATALOGUE
    summary = "The program gets a reading 0.5 s after it was taken; the world goes on meanwhile."
    rank = 348
    asks_wait = True
    stands_for = f"Something too early, too late or in the wrong order: {TIMING}."
    where = "calls that read and command nothing; the vocabulary says how time passes: wait"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MEASURE),
            replied={"result": 0.2},
            performed=({},),
            received={"result": 0.2},
            waited=_LATE,
        ),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterator[Subject]:
        whole = Subject(operation, pattern)
        comes = operation.named is not None and operation.named.form in COMING
        if whole.read and not whole.is_command and not comes:
            yield whole

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        async def mutated(call: Call, proceed: Proceed) -> Reply:
            reply = await proceed(call)
            await call.wait(_LATE)
            return reply

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return f"read {_LATE:g} s before the program gets it"
