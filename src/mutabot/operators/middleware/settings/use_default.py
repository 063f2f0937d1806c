"""use-default: a parameter has its default instead of what was set."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random
from typing import ClassVar

from mutabot.families import MIDDLEWARE
from mutabot.model import Call, Middleware, Operation, Pattern, Proceed, Reply
from mutabot.model.named import DEFAULT, Form
from mutabot.model.values.quantity import Value
from mutabot.model.values.sameness import is_same
from mutabot.operators.middleware._examples import SPEED
from mutabot.operators.middleware._forms import form_of
from mutabot.operators.middleware._values import NOT_GIVEN, quantity_of
from mutabot.operators.operator import Example, Operator, Subject

_VALUE = SPEED.result[0]
_NO_DEFAULT = "the program gives no default"
_IS_DEFAULT = "it has its default"


class UseDefault(Operator):
    """Reads the default of a parameter."""

    name = "use-default"
    family = MIDDLEWARE
    summary = "A parameter has the default that the program gives, instead of what was set."
    rank = 380
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(SPEED, quantity=_VALUE),
            {"default": 1.0},
            {"value": 0.25},
            performed=({"default": 1.0},),
            received={"value": 1.0},
        ),
        Example(Subject(SPEED, quantity=_VALUE), {}, {"value": 0.25}, away=_NO_DEFAULT),
        Example(Subject(SPEED, quantity=_VALUE), {"default": 0.25}, {"value": 0.25}, away=_IS_DEFAULT),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        if form_of(operation) is Form.PARAMETER:
            yield from (Subject(operation, pattern, one) for one in operation.result if not one.path.steps)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        quantity = quantity_of(subject)

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            reply = await proceed(call)
            if DEFAULT.name not in call.values:
                return reply.as_is(_NO_DEFAULT)
            if quantity.name not in reply.values:
                return reply.as_is(NOT_GIVEN)
            default = call.values[DEFAULT.name]
            is_default = is_same(quantity, default, reply.values[quantity.name])
            return reply.as_is(_IS_DEFAULT) if is_default else reply.with_value(quantity, default)

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        one, other = quantity_of(subject).texts(before, after)
        return f"the default {other} instead of {one}"
