"""delay: a message, request or goal is late."""

from __future__ import annotations

from collections.abc import Iterable
from random import Random
from typing import ClassVar

from mutabot.model import Call, Middleware, Mishap, Operation, Pattern, Proceed, Reply
from mutabot.model.named import COMING, WRITTEN, Form
from mutabot.operators.middleware._examples import CALL, PUBLISH, RECEIVE
from mutabot.operators.middleware._forms import FormOperator, form_of, seconds_in
from mutabot.operators.operator import Example, Subject

#: seconds: a network that is busy, and one that has trouble
_SIZES = (0.1, 1.0)


class Delay(FormOperator):
    """Lets the call, or what it brings, come later."""

    name = "delay"
    summary = (
        "A message, request, goal, result or transform comes 0.1 s or 1 s late, by the clock of the node. "
        "What is published goes out late by itself; who waits for an answer waits longer."
    )
    rank = 140
    forms = frozenset({*WRITTEN, *COMING, Form.RESULT, Form.TRANSFORM, Form.SLEEP})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(
            Subject(PUBLISH, variant="0.1", magnitude=0.1), {"x": 0.4}, performed=({"x": 0.4, "late": 0.1},)
        ),
        Example(Subject(CALL, variant="1", magnitude=1.0), performed=({"late": 1.0},)),
        Example(
            Subject(RECEIVE, variant="1", magnitude=1.0),
            replied={"gap": 0.02},
            performed=({},),
            received={"gap": 0.02},
            late=1.0,
            note="the callback is called later; messages that come meanwhile overtake it",
        ),
    )

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        for subject in super().subjects(operation, pattern):
            yield from seconds_in(subject, _SIZES)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        writes = form_of(subject.operation) in WRITTEN
        seconds = subject.magnitude or 0.0

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            why = call.cannot(Mishap.LATE)
            if why:
                return await proceed(call.as_is(why))
            if writes:
                return await proceed(call.with_mishap(Mishap.LATE, seconds))
            return (await proceed(call)).later(seconds)

        return mutated

    def fault(self, subject: Subject, what: str) -> str:
        return f"each {what} comes {subject.variant} s late"
