"""dropout: a reading is not there."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from random import Random
from typing import ClassVar

from mutabot.families import CATALOGUE
from mutabot.model import Call, Kind, Middleware, Operation, Path, Pattern, Proceed, Quantity, Reply
from mutabot.model.named import COMING
from mutabot.model.values.quantity import Value
from mutabot.operators._evidence import SENSORS
from mutabot.operators.operator import Example, Operator, Subject, map_numbers
from mutabot.operators.robot._values import NOT_GIVEN, label, quantity_of

_NONE, _NAN = "none", "nan"
_GAP = Quantity("result", Path(), Kind.DISTANCE, None, "m", missing=_NAN)
_MEASURE = Operation("laser:distance", result=(_GAP,), command=False)
_X = Quantity(".x", Path.parse(".x", rooted=False), Kind.POSITION, "x", "m", missing="camera:NoImageError")
_LOCATE = Operation("camera:locate", result=(_X,), command=False)
_COLOUR = Quantity("result", Path(), Kind.LABEL, values=("red", "blue"), missing=_NONE)
_SEE = Operation("camera:colour", result=(_COLOUR,), command=False)


class Dropout(Operator):
    """Gives what the vocabulary says that a reading gives which is not there."""

    name = "dropout"
    family = CATALOGUE
    summary = (
        "A reading drops out: the program gets None, not a number or an exception, as the robot's API"
        " does it."
    )
    rank = 340
    stands_for = f"A sensor that drops out or is misread: {SENSORS}."
    where = "read quantities whose vocabulary says what a reading gives that is not there: missing"
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(_MEASURE, quantity=_GAP),
            replied={"result": 0.2},
            performed=({},),
            received={"result": math.nan},
        ),
        Example(
            Subject(_SEE, quantity=_COLOUR),
            replied={"result": "red"},
            performed=({},),
            received={"result": None},
        ),
        Example(
            Subject(_LOCATE, quantity=_X), replied={".x": 0.2}, performed=({},), fails="camera:NoImageError"
        ),
        Example(Subject(_MEASURE, quantity=_GAP), replied={}, away="there is no reading anyway"),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterator[Subject]:
        whole = Subject(operation, pattern)
        comes = operation.named is not None and operation.named.form in COMING
        raised: set[str] = set()
        for quantity in whole.read:
            if quantity.missing in (_NONE, _NAN):
                yield replace(whole, quantity=quantity)
            elif quantity.missing is not None and not comes and quantity.missing not in raised:
                raised.add(quantity.missing)  # the whole call raises; what comes by itself raises nothing
                yield replace(whole, quantity=quantity)

    def only_reads(self, subject: Subject) -> bool:
        return quantity_of(subject).missing in (_NONE, _NAN)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        quantity = quantity_of(subject)

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            reply = await proceed(call)
            if quantity.name not in reply.values:
                return reply.as_is(NOT_GIVEN)
            if quantity.missing == _NONE:
                return reply.with_value(quantity, None)
            if quantity.missing != _NAN:
                return reply.failing(quantity.missing or "")
            nothing = map_numbers(reply.values[quantity.name], lambda _: math.nan)
            if nothing is None:
                return reply.as_is("its value is no number")
            return reply.with_value(quantity, nothing)

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        quantity = quantity_of(subject)
        gets = {_NONE: "reads None", _NAN: "reads not a number"}
        what = gets.get(quantity.missing or "", f"raises {quantity.missing}")
        return f"{what} instead of {label(quantity)} {quantity.text(before)}"
