"""Commands that are not carried out, carried out twice, or turned round."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mutabot.model import Call, Kind, Operation, Pattern, Proceed, Quantity, Reply
from mutabot.model.notation import Notation
from mutabot.operators.command import CommandOperator, idle_of
from mutabot.operators.examples import CLOSE, GRIP, MOVE_BY, changed, unchanged, whole, writing
from mutabot.operators.operator import Context, Example, Need, Subject, Unchanged

if TYPE_CHECKING:
    from mutabot.model.quantity import Value

_HOME = Operation("robot:Arm.home")
_OPEN_TO = writing("robot:Gripper.move", "width", Kind.OPENING, unit="mm", range=(0.0, 85.0))
_LAMP = writing("robot:Lamp.set", "lit", Kind.OUTPUT, values=(False, True))
_FAN = writing("robot:Fan.set", "mode", Kind.OUTPUT, values=("off", "slow", "fast"))
_LIFT = Pattern("lift/{height:g}", opposite="drop/{height:g}")
_SEND = Operation("link:send", message="text", patterns=(_LIFT,))


class Skip(CommandOperator):
    """A command is not carried out; the program goes on as if it had been.

    Where: commands whose answer to doing nothing is known.

    Published: 7. do command x → do nothing
    """

    name = "skip"
    needs = frozenset({Need.IDLE})
    does_nothing = True
    fault = "do nothing"
    examples = (Example(Subject(GRIP), {"position": 1}, performed=()), Example(Subject(_HOME), performed=()))

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        return idle_of(call)


class Repeat(CommandOperator):
    """A command is carried out twice; the program sees the second answer.

    Where: any command.

    Published: 8. do command x → do command x twice
    """

    name = "repeat"
    fault = "do it twice"
    examples = (whole(MOVE_BY, 0.1, 0.1, 0.1),)

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
        changed(GRIP, 1, 0),
        changed(_LAMP, False, True),
        changed(_OPEN_TO, 85.0, 0.0),
        Example(Subject(CLOSE), performed=({"reversed": True},)),
        Example(Subject(_SEND, _LIFT), {"height": 5}, performed=({"height": 5, "reversed": True},)),
        unchanged(_OPEN_TO, 40.0, "half open has no opposite"),
        unchanged(GRIP, 0.5, "neither of the two states"),
        unchanged(_FAN, "slow", "three states have no opposite"),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterator[Subject]:
        whole = Subject(operation, pattern)
        for quantity in whole.written:
            if quantity.kind in (Kind.OPENING, Kind.OUTPUT) and _ends(quantity) is not None:
                yield Subject(operation, pattern, quantity)
        if whole.opposite is not None:
            yield whole

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        quantity = context.subject.quantity
        if quantity is None:
            return await proceed(call.opposite())
        return await proceed(call.with_value(quantity, other_end(quantity, call.values.get(quantity.name))))

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        if subject.quantity is not None:
            return f"{subject.quantity.name} {' → '.join(subject.quantity.texts(before, after))}"
        pattern, opposite = subject.pattern, subject.opposite
        if opposite is not None and pattern is not None and pattern.notation is not None:
            return f"{Notation.compile(opposite).short} instead"
        return f"{opposite} instead"


def _ends(quantity: Quantity) -> tuple[Value, Value] | None:
    if quantity.values is not None:
        return (quantity.values[0], quantity.values[1]) if len(quantity.values) == 2 else None
    return quantity.range or quantity.clip


def other_end(quantity: Quantity, value: Value) -> Value:
    """The other of a quantity's two states. Raises Unchanged if the value is neither."""
    ends = _ends(quantity)
    value = quantity.clipped(value)
    if ends is None or value is None or value not in ends:
        raise Unchanged("the value is neither of the two ends")
    return ends[1] if value == ends[0] else ends[0]
