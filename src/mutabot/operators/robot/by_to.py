"""by-to: a relative amount is taken for an absolute target, or the other way round."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random
from typing import ClassVar

from mutabot.model import (
    Call,
    Kind,
    Middleware,
    Mode,
    NotToldError,
    Operation,
    Path,
    Pattern,
    Proceed,
    Quantity,
    Reply,
)
from mutabot.model.values.quantity import READING_OF, Value
from mutabot.operators.operator import Example, Operator, Subject, is_number
from mutabot.operators.rule import Published

from ._values import NOT_GIVEN, NOT_TOLD, label, quantity_of, why_away

_DX = Quantity("dx", Path("dx"), Kind.TRANSLATION, "x", "m", "base", Mode.BY)
_X = Quantity("x", Path("x"), Kind.TRANSLATION, "x", "m", "base", Mode.TO)
_X_NEAR = Quantity("x", Path("x"), Kind.TRANSLATION, "x", "m", "base", Mode.TO, range=(0.0, 0.6))
_BY = Operation("robot:Arm.move_by", (_DX,), current="robot:Arm.tool_pose")
_TO = Operation("robot:Arm.move_to", (_X,), current="robot:Arm.tool_pose")
_PATH = Path.parse("message.pose.x", rooted=True)
_GOAL = Quantity("pose.x", _PATH, Kind.TRANSLATION, "x", "m", mode=Mode.TO, relative=True)
_HIDDEN = Operation("publish /arm/goal", (_GOAL,), current="receive /arm/pose")
_NEAR = Operation("robot:Arm.move_to", (_X_NEAR,), current="robot:Arm.tool_pose")


class ByTo(Operator):
    """Confuses relative and absolute."""

    name = "by-to"
    asks_where = True
    summary = "A relative amount is taken for an absolute target, and the other way round."
    rank = 20
    where = "written translations and rotations whose operation has a current that tells them"
    published = (
        Published(5, "translate forward by δ", "translate forward *to* δ"),
        Published(6, "translate backwards by δ", "translate backwards *to* δ"),
    )
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_BY, quantity=_DX),
            {"dx": 0.5},
            current={"dx": 0.25},
            performed=({"dx": 0.25},),
            note="translate forward by δ: translate forward to δ",
        ),
        Example(Subject(_BY, quantity=_DX), {"dx": -0.5}, current={"dx": 0.25}, performed=({"dx": -0.75},)),
        Example(Subject(_TO, quantity=_X), {"x": 0.5}, current={"x": 0.25}, performed=({"x": 0.75},)),
        Example(Subject(_BY, quantity=_DX), {"dx": 0.5}, current={"dx": 0.0}, away="by and to agree at zero"),
        Example(
            Subject(_HIDDEN, quantity=_GOAL),
            {"pose.x": 0.5},
            current={"pose.x": 0.3},
            performed=({"pose.x": 0.2},),
            note="a relative move that is hidden in an absolute target: its change is taken for the target",
        ),
        Example(
            Subject(_NEAR, quantity=_X_NEAR), {"x": 0.5}, current={"x": 0.25}, away="0.75 is out of range"
        ),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        whole = Subject(operation, pattern)
        if whole.current is None:
            return []
        return [
            Subject(operation, pattern, quantity) for quantity in whole.written if quantity.kind in READING_OF
        ]

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        quantity = quantity_of(subject)
        # the relative move that is hidden in an absolute target is that target less the place
        sign = -1.0 if quantity.mode is Mode.BY or quantity.relative else 1.0

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            value = call.values.get(quantity.name)
            if value is None or not is_number(value):
                return await proceed(call.as_is(NOT_GIVEN))
            if quantity.mode is Mode.BY and value == 0:
                return await proceed(call.as_is("the amount is zero"))
            try:
                changed = value + sign * await call.current(quantity)
            except NotToldError:
                return await proceed(call.as_is(NOT_TOLD))
            why = why_away(quantity, value, changed)
            return await proceed(call.as_is(why) if why else call.with_value(quantity, changed))

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        if quantity.relative:
            return f"{label(quantity)} {quantity.text(before)} → the change alone, taken for the target"
        was, becomes = ("by", "to") if quantity.mode is Mode.BY else ("to", "by")
        amount = quantity.text(before)
        return f"{label(quantity)} {was} {amount} → {becomes} {amount}"
