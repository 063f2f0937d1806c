"""double-command: a command is carried out twice now and then."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Kind, Middleware, Mode, Operation, Path, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.operators._draws import Draws
from mutabot.operators._evidence import COMMANDS
from mutabot.operators.catalogue._commands import CommandFault
from mutabot.operators.operator import Example, Subject

_SHARES = {"30%": 0.3}
_DX = Quantity("dx", Path("dx"), Kind.TRANSLATION, "x", "m", "base", Mode.BY)
_MOVE = Operation("robot:Arm.move_by", (_DX,))


class DoubleCommand(CommandFault):
    """Proceeds twice, by chance."""

    name = "double-command"
    summary = (
        "A command is carried out twice, with a probability of 30 %; the program sees the second answer."
    )
    rank = 335
    remembers = True
    copies = False
    stands_for = f"A command that is lost, or comes twice: {COMMANDS}."
    where = "any command"
    variants = tuple(_SHARES)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_MOVE, variant="30%"), {"dx": 0.1}, performed=({"dx": 0.1}, {"dx": 0.1})),
        Example(
            Subject(_MOVE, variant="30%"),
            {"dx": 0.1},
            earlier=({"dx": 0.2},) * 3,
            away="most commands are carried out once",
        ),
    )

    def is_chance(self, subject: Subject) -> bool:
        return True

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        draws = Draws(random)

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            if draws.next().random() >= _SHARES[subject.variant]:
                return await proceed(call.as_is("chance spares it"))
            await proceed(call)
            return await proceed(call)

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return f"do it twice, with a probability of {subject.variant}"
