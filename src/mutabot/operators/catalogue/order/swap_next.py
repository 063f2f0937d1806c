"""swap-next: two neighbouring commands change places."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Kind, Middleware, Mode, Operation, Path, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import TIMING
from mutabot.operators.catalogue._commands import CommandFault, idle_of
from mutabot.operators.operator import Example, Subject

_DX = Quantity("dx", Path("dx"), Kind.TRANSLATION, "x", "m", "base", Mode.BY)
_MOVE = Operation("robot:Arm.move_by", (_DX,))


class SwapNext(CommandFault):
    """Holds a command back until the next one is made."""

    name = "swap-next"
    summary = (
        "A command changes places with the program's next one, whichever that is; if none follows, it is"
        " never carried out. Meanwhile the program goes on as if it had been."
    )
    rank = 330
    asks_idle = True
    stands_for = f"Something too early, too late or in the wrong order: {TIMING}."
    where = "any command whose answer to doing nothing is known"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_MOVE), {"dx": 0.1}, performed=(), afterwards=({"dx": 0.1},)),
    )

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        async def mutated(call: Call, proceed: Proceed) -> Reply:
            reply = idle_of(call)
            call.defer(call)
            return reply

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return "only after the next command"
