"""repeat: a command is carried out twice."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random
from typing import ClassVar

from mutabot.model import Call, Kind, Middleware, Mode, Operation, Path, Pattern, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.operators.operator import Example, Operator, Subject
from mutabot.operators.rule import Published

_DX = Quantity("dx", Path("dx"), Kind.TRANSLATION, "x", "m", "base", Mode.BY)
_MOVE = Operation("robot:Arm.move_by", (_DX,))


class Repeat(Operator):
    """Proceeds twice."""

    name = "repeat"
    summary = "A command is carried out twice; the program sees the second answer."
    rank = 40
    where = "any command"
    published = (Published(8, "do command x", "do command x twice"),)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MOVE),
            {"dx": 0.1},
            performed=({"dx": 0.1}, {"dx": 0.1}),
            note="do command x: do command x twice",
        ),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        subject = Subject(operation, pattern)
        return [subject] if subject.is_command else []

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        async def mutated(call: Call, proceed: Proceed) -> Reply:
            await proceed(call)
            return await proceed(call)

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return "do it twice"
