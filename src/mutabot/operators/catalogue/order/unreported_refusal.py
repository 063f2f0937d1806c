"""unreported-refusal: the robot refuses a command, and nobody tells the program."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Kind, Middleware, Mode, Operation, Path, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import COMMANDS
from mutabot.operators.catalogue._commands import CommandFault, idle_of
from mutabot.operators.operator import Example, Subject

_DX = Quantity("dx", Path("dx"), Kind.TRANSLATION, "x", "m", "base", Mode.BY)
_MOVE = Operation("robot:Arm.move_by", (_DX,), refusals=("robot:Refused",))


class UnreportedRefusal(CommandFault):
    """Answers as if nothing were wrong where the robot raises one of its refusals."""

    name = "unreported-refusal"
    summary = (
        "The robot refuses a command, or stops, and the program does not hear of it: it gets the answer"
        " to doing nothing."
    )
    rank = 338
    asks_idle = True
    needs_error = True
    stands_for = f"Errors that are swallowed on their way: {COMMANDS}."
    where = (
        "commands whose answer to doing nothing is known, where the tests make the robot raise one of"
        " its refusals"
    )
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_MOVE), {"dx": 9.0}, refused=True, performed=({"dx": 9.0},), received={}),
        Example(Subject(_MOVE), {"dx": 0.1}, away="the robot does not refuse it"),
    )

    def is_chance(self, subject: Subject) -> bool:
        return True  # what the robot refuses only the run can tell

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        async def mutated(call: Call, proceed: Proceed) -> Reply:
            try:
                reply = await proceed(call)
            except Exception as error:
                if not call.is_refusal(error):
                    raise
                return idle_of(call)
            return reply.as_is("the robot does not refuse it")

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return "a refusal is not reported"
