"""lost-command: a command is lost now and then."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Kind, Middleware, Operation, Path, Proceed, Quantity, Reply
from mutabot.model.values.quantity import Value
from mutabot.operators._draws import Draws
from mutabot.operators._evidence import COMMANDS
from mutabot.operators.catalogue._commands import CommandFault, idle_of
from mutabot.operators.operator import Example, Subject

_SHARES = {"30%": 0.3}
_POSITION = Quantity("position", Path("position"), Kind.OPENING, unit="fraction", values=(0, 1))
_GRIP = Operation("robot:Gripper.command", (_POSITION,))


class LostCommand(CommandFault):
    """Does not proceed, by chance."""

    name = "lost-command"
    summary = (
        "A command is not carried out, with a probability of 30 %; the program goes on as if it had been."
    )
    rank = 334
    asks_idle = True
    remembers = True
    copies = False
    stands_for = f"A command that is lost, or comes twice: {COMMANDS}."
    where = "any command whose answer to doing nothing is known"
    variants = tuple(_SHARES)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(_GRIP, variant="30%"), {"position": 1}, performed=()),
        Example(
            Subject(_GRIP, variant="30%"),
            {"position": 1},
            earlier=({"position": 0},) * 3,
            away="most commands are carried out",
        ),
    )

    def is_chance(self, subject: Subject) -> bool:
        return True

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        draws = Draws(random)

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            if draws.next().random() >= _SHARES[subject.variant]:
                return await proceed(call.as_is("chance spares it"))
            return idle_of(call)

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return f"do nothing, with a probability of {subject.variant}"
