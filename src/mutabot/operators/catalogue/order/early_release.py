"""early-release: a gripper goes back right after the next command."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Middleware, Proceed, Reply
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import TIMING
from mutabot.operators.catalogue._commands import CommandFault
from mutabot.operators.catalogue._shape import Away
from mutabot.operators.operator import Example, Subject

from ._gripping import CLOSE, GRIP, WHERE, is_gripping, undone


class EarlyRelease(CommandFault):
    """Takes a gripper command back after the next command of the program."""

    name = "early-release"
    summary = (
        "A gripper command is taken back right after the program's next command: what was gripped is let"
        " go too early. If no command follows, nothing happens."
    )
    rank = 337
    stands_for = f"Something too early, too late or in the wrong order: {TIMING}."
    where = WHERE
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(GRIP), {"position": 1}, performed=({"position": 1},), afterwards=({"position": 0},)),
        Example(Subject(CLOSE), performed=({},), afterwards=({"reversed": True},)),
        Example(Subject(GRIP), {"position": 0.5}, away="half open has no opposite"),
    )

    def fits(self, whole: Subject) -> bool:
        return is_gripping(whole)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        async def mutated(call: Call, proceed: Proceed) -> Reply:
            try:
                back = undone(subject, call)
            except Away as away:
                return await proceed(call.as_is(str(away)))
            reply = await proceed(call)
            call.defer(back)
            return reply

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return "and back after the next command"
