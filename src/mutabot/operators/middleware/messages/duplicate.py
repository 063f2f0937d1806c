"""duplicate: a message, request or goal arrives twice."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Middleware, Proceed, Reply
from mutabot.model.named import COMING, Form
from mutabot.operators.middleware._examples import CALL, PUBLISH, RECEIVE
from mutabot.operators.middleware._forms import FormOperator, form_of
from mutabot.operators.operator import Example, Subject


class Duplicate(FormOperator):
    """Proceeds twice, or lets the program receive twice."""

    name = "duplicate"
    summary = "A message, request or goal arrives twice, a callback is called twice."
    rank = 120
    forms = frozenset({Form.PUBLISH, Form.CALL, Form.GOAL, *COMING})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(PUBLISH), {"x": 0.4}, performed=({"x": 0.4}, {"x": 0.4})),
        Example(
            Subject(RECEIVE),
            replied={"gap": 0.02},
            performed=({},),
            received={"gap": 0.02},
            then=({"gap": 0.02},),
        ),
        Example(Subject(CALL), performed=({}, {}), note="the program sees the second answer"),
    )

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        comes = form_of(subject.operation) in COMING

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            reply = await proceed(call)
            return reply.followed_by(reply) if comes else await proceed(call)

        return mutated

    def fault(self, subject: Subject, what: str) -> str:
        return f"each {what} arrives twice"
