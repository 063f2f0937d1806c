"""skip: a command is not carried out."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random
from typing import ClassVar

from mutabot.model import Call, Kind, Middleware, Operation, Path, Pattern, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.operators.operator import Example, Operator, Subject
from mutabot.operators.rule import Published

_POSITION = Quantity("position", Path("position"), Kind.OPENING, unit="fraction", values=(0, 1))
_GRIP = Operation("robot:Gripper.command", (_POSITION,))
_HOME = Operation("robot:Arm.home")


class Skip(Operator):
    """Does not proceed."""

    name = "skip"
    asks_idle = True
    does_nothing = True
    summary = "A command is not carried out; the program goes on as if it had been."
    rank = 30
    where = "commands whose answer to doing nothing is known"
    published = (Published(7, "do command x", "do nothing"),)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_GRIP), {"position": 1}, performed=(), note="do command x: do nothing"),
        Example(Subject(_HOME), performed=()),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        subject = Subject(operation, pattern)
        return [subject] if subject.is_command else []

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        async def mutated(call: Call, proceed: Proceed) -> Reply:
            if call.idle is None:
                raise LookupError(f"nobody knows what {call.operation.name} answers to doing nothing")
            return call.idle

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return "do nothing"
