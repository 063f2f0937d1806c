"""late-grip: a gripper acts only after a while."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Middleware, Proceed, Reply
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import TIMING
from mutabot.operators.catalogue._commands import CommandFault
from mutabot.operators.operator import Example, Subject

from ._gripping import GRIP, WHERE, is_gripping

#: seconds: as long as a pneumatic gripper takes to open or close
_LATE = 0.5


class LateGrip(CommandFault):
    """Lets time pass before a gripper command is made."""

    name = "late-grip"
    summary = "A gripper command is carried out 0.5 s late, and the program waits for it."
    rank = 336
    asks_wait = True
    stands_for = f"Something too early, too late or in the wrong order: {TIMING}."
    where = f"{WHERE}; the vocabulary says how time passes: wait"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(GRIP), {"position": 1}, waited=_LATE, performed=({"position": 1},)),
    )

    def fits(self, whole: Subject) -> bool:
        return is_gripping(whole)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        async def mutated(call: Call, proceed: Proceed) -> Reply:
            await call.wait(_LATE)
            return await proceed(call)

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return f"{_LATE:g} s late"
