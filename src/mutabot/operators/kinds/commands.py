"""Operators on commands: left out, repeated, or replaced by the opposite."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from mutabot.model import Call, Kind, Operation, Pattern, Proceed, Reply, Unchanged
from mutabot.model.notation import Notation
from mutabot.operators.command import CommandOperator
from mutabot.operators.examples import CLOSE, GRIP, MOVE_BY
from mutabot.operators.operator import Context, Example, Need, Subject

if TYPE_CHECKING:
    from mutabot.model.quantity import Value

_HOME = Operation("robot:Arm.home")
_OPEN_TO = Operation.writing("robot:Gripper.move", "width", Kind.OPENING, unit="mm", range=(0.0, 85.0))
_LAMP = Operation.writing("robot:Lamp.set", "lit", Kind.OUTPUT, values=(False, True))
_FAN = Operation.writing("robot:Fan.set", "mode", Kind.OUTPUT, values=("off", "slow", "fast"))
_LIFT = Pattern("lift/{height:g}", opposite="drop/{height:g}")
_SEND = Operation("link:send", message="text", patterns=(_LIFT,))


class Skip(CommandOperator):
    """A command is not carried out; the program goes on as if it had been.

    Where: commands whose answer to doing nothing is known.

    Published: 7. do command x → do nothing
    """

    name = "skip"
    is_common = True
    needs = frozenset({Need.IDLE})
    does_nothing = True
    fault = "do nothing"
    examples = (Example(Subject(GRIP), {"position": 1}, performed=()), Example(Subject(_HOME), performed=()))

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        return call.idle_reply


class Repeat(CommandOperator):
    """A command is carried out twice; the program sees the second answer.

    Where: any command.

    Published: 8. do command x → do command x twice
    """

    name = "repeat"
    fault = "do it twice"
    examples = (Example.whole(MOVE_BY, 0.1, 0.1, 0.1),)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        await proceed(call)
        return await proceed(call)


class Opposite(CommandOperator):
    """A two-state command does the opposite: open for close, off for on, `drop/5` for `lift/5`; an opening
    goes to the other end of its range.

    Where: written openings and outputs with two ends, and commands with an opposite.

    Published: 11. do command x → do the opposite, such as release for grasp
    """

    name = "opposite"
    examples = (
        Example.changed(GRIP, 1, 0),
        Example.changed(_LAMP, False, True),
        Example.changed(_OPEN_TO, 85.0, 0.0),
        Example(Subject(CLOSE), performed=({"reversed": True},)),
        Example(Subject(_SEND, _LIFT), {"height": 5}, performed=({"height": 5, "reversed": True},)),
        Example.unchanged(_OPEN_TO, 40.0, "half open has no opposite"),
        Example.unchanged(GRIP, 0.5, "neither of the two states"),
        Example.unchanged(_FAN, "slow", "three states have no opposite"),
    )

    def subjects(self, whole: Subject) -> Iterator[Subject]:
        for quantity in whole.written:
            if quantity.kind in (Kind.OPENING, Kind.OUTPUT) and quantity.ends is not None:
                yield replace(whole, quantity=quantity)
        if whole.opposite is not None:
            yield whole

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        quantity = context.subject.quantity
        if quantity is None:
            return await proceed(call.opposite())
        end = quantity.other_end(call.values.get(quantity.name))
        if end is None:
            raise Unchanged(f"the value is at neither end of the range or values of {quantity.name}")
        return await proceed(call.with_value(quantity, end))

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        if subject.quantity is not None:
            return f"{subject.quantity.name} {' → '.join(subject.quantity.texts(before, after))}"
        pattern, opposite = subject.pattern, subject.opposite
        if opposite is not None and pattern is not None and pattern.notation is not None:
            return f"{Notation.compile(opposite).short} instead"
        return f"{(opposite or '').rpartition(':')[2]} instead"
