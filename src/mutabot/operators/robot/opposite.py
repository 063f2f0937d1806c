"""opposite: a two-state command does the opposite."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random
from typing import ClassVar

from mutabot.model import Call, Kind, Middleware, Operation, Path, Pattern, Proceed, Quantity, Reply
from mutabot.model.values.notation import Notation
from mutabot.model.values.quantity import Value
from mutabot.operators.operator import Example, Operator, Subject
from mutabot.operators.rule import Published

_POSITION = Quantity("position", Path("position"), Kind.OPENING, unit="fraction", values=(0, 1))
_WIDTH = Quantity("width", Path("width"), Kind.OPENING, unit="mm", range=(0.0, 85.0))
_GRIP = Operation("robot:Gripper.command", (_POSITION,))
_OPEN_TO = Operation("robot:Gripper.move", (_WIDTH,))
_CLOSE = Operation("robot:Gripper.close", opposite="robot:Gripper.open")
_LAMP = Operation("robot:Lamp.set", (Quantity("lit", Path("lit"), Kind.OUTPUT, values=(False, True)),))
_THREE = Quantity("mode", Path("mode"), Kind.OUTPUT, values=("off", "slow", "fast"))
_FAN = Operation("robot:Fan.set", (_THREE,))
_LIFT = Pattern("lift/{height:g}", opposite="drop/{height:g}")
_SEND = Operation("link:send", message="text", patterns=(_LIFT,))


class Opposite(Operator):
    """Does the opposite of a two-state command, or the operation named as the opposite."""

    name = "opposite"
    summary = "A two-state command does the opposite: open for close, off for on, release for grasp."
    rank = 50
    where = "written openings and outputs with two ends, and commands with an opposite"
    published = (Published(11, "do command x", "do the opposite, such as release for grasp"),)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_GRIP, quantity=_POSITION),
            {"position": 1},
            performed=({"position": 0},),
            note="grasp: release",
        ),
        Example(Subject(_LAMP, quantity=_LAMP.arguments[0]), {"lit": False}, performed=({"lit": True},)),
        Example(
            Subject(_OPEN_TO, quantity=_WIDTH),
            {"width": 85.0},
            performed=({"width": 0.0},),
            note="an opening at one end of its range goes to the other end",
        ),
        Example(Subject(_CLOSE), performed=({"reversed": True},), note="calls the opposite operation"),
        Example(
            Subject(_SEND, _LIFT),
            {"height": 5},
            performed=({"height": 5, "reversed": True},),
            note="sends the opposite text command",
        ),
        Example(Subject(_OPEN_TO, quantity=_WIDTH), {"width": 40.0}, away="half open has no opposite"),
        Example(Subject(_GRIP, quantity=_POSITION), {"position": 0.5}, away="neither of the two states"),
        Example(Subject(_FAN, quantity=_THREE), {"mode": "slow"}, away="three states have no opposite"),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        whole = Subject(operation, pattern)
        for quantity in whole.written:
            if quantity.kind in (Kind.OPENING, Kind.OUTPUT) and _ends(quantity) is not None:
                yield Subject(operation, pattern, quantity)
        if whole.opposite is not None:
            yield whole

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        quantity = subject.quantity

        async def whole(call: Call, proceed: Proceed) -> Reply:
            return await proceed(call.opposite())

        async def toggled(call: Call, proceed: Proceed) -> Reply:
            assert quantity is not None
            value = other_end(quantity, call.values.get(quantity.name))
            if value is None:
                return await proceed(call.as_is("the value is neither of the two ends"))
            return await proceed(call.with_value(quantity, value))

        return whole if quantity is None else toggled

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        if subject.quantity is not None:
            quantity = subject.quantity
            return f"{quantity.name} {' → '.join(quantity.texts(before, after))}"
        pattern, opposite = subject.pattern, subject.opposite
        if opposite is not None and pattern is not None and pattern.notation is not None:
            return f"{Notation.compile(opposite).short} instead"
        return f"{opposite} instead"


def _ends(quantity: Quantity) -> tuple[Value, Value] | None:
    if quantity.values is not None:
        return (quantity.values[0], quantity.values[1]) if len(quantity.values) == 2 else None
    return quantity.range or quantity.clip


def other_end(quantity: Quantity, value: Value) -> Value | None:
    """The other of a quantity's two states, or None if the value is neither."""
    ends = _ends(quantity)
    value = quantity.clipped(value)
    if ends is None or value is None or value not in ends:
        return None
    return ends[1] if value == ends[0] else ends[0]
