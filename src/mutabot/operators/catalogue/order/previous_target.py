"""previous-target: a motion goes to the previous target again."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from typing import ClassVar

from mutabot.model import Call, Kind, Middleware, Mode, Operation, Path, Proceed, Quantity, Reply
from mutabot.model.values.quantity import WHOLE, Value
from mutabot.model.values.sameness import are_same
from mutabot.operators._evidence import TIMING
from mutabot.operators.catalogue._commands import CommandFault
from mutabot.operators.operator import Example, Subject

_KINDS = WHOLE | {Kind.TRANSLATION, Kind.ROTATION}
_X, _Y = (Quantity(name, Path(name), Kind.TRANSLATION, name, "m", "base", Mode.TO) for name in "xy")
_MOVE = Operation("robot:Arm.move_to", (_X, _Y))


class PreviousTarget(CommandFault):
    """Writes the motion that the call of this operation before wrote, wherever that stands."""

    name = "previous-target"
    summary = (
        "A motion goes to the target of the one before it again, or as far: a waypoint that is out of date."
    )
    rank = 331
    stands_for = f"Something too early, too late or in the wrong order: {TIMING}."
    where = "commands that write a translation or rotation, from the second call of their operation on"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MOVE),
            {"x": 0.4, "y": 0.1},
            previous={"x": 0.2, "y": 0.0},
            performed=({"x": 0.2, "y": 0.0},),
        ),
        Example(Subject(_MOVE), {"x": 0.4}, away="there is none before it"),
        Example(Subject(_MOVE), {"x": 0.4}, previous={"x": 0.4}, away="it went there before"),
    )

    def fits(self, whole: Subject) -> bool:
        return any(one.kind in _KINDS for one in whole.written)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        names = [one.name for one in subject.written if one.kind in _KINDS]

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            before = call.previous()
            if before is None:
                return await proceed(call.as_is("there is none before it"))
            again = {name: before[name] for name in names if name in before and name in call.values}
            values = {**call.values, **again}
            if are_same(subject.written, values, call.values):
                return await proceed(call.as_is("the one before it was the same"))
            return await proceed(replace(call, values=values))

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return "the motion of the call before it again"
