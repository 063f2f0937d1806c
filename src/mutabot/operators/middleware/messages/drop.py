"""drop: a message, request or goal is lost on its way."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Middleware, Proceed, Reply
from mutabot.model.named import COMING, Form
from mutabot.operators.middleware._examples import CALL, PUBLISH, RECEIVE
from mutabot.operators.middleware._forms import FormOperator, form_of
from mutabot.operators.operator import Example, Subject

_THIRD = "every-3rd"
_CHANCE = "30%"
_PROBABILITY = 0.3
#: forms of which the middleware has the message already when it is lost
_READ = COMING | {Form.RESULT}


class Drop(FormOperator):
    """Lets the call, or what it brings, be lost."""

    name = "drop"
    summary = (
        "A message, request or goal is lost on its way, a result or the tick of a timer never comes: each,"
        " every third, or with a probability of 30 %."
    )
    rank = 110
    remembers = True
    forms = frozenset({Form.PUBLISH, Form.CALL, Form.GOAL, *_READ})
    variants = ("", _THIRD, _CHANCE)
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(PUBLISH), {"x": 0.4}, performed=(), note="nobody hears of it"),
        Example(
            Subject(RECEIVE),
            replied={"gap": 0.02},
            performed=({},),
            lost=True,
            note="the callback is not called; who waits, waits for the next one",
        ),
        Example(Subject(CALL), lost=True, note="the service does nothing and never answers"),
        Example(Subject(PUBLISH, variant=_THIRD), {"x": 0.4}, earlier=({"x": 0.2}, {"x": 0.3}), performed=()),
        Example(Subject(PUBLISH, variant=_THIRD), {"x": 0.3}, earlier=({"x": 0.2},), away="only the second"),
    )

    def least_calls(self, subject: Subject) -> int:
        return 3 if subject.variant else 1

    def is_chance(self, subject: Subject) -> bool:
        return subject.variant == _CHANCE

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        form = form_of(subject.operation)
        count = 0

        def is_meant() -> bool:
            nonlocal count
            count += 1
            if subject.variant == _CHANCE:
                return random.random() < _PROBABILITY
            return subject.variant != _THIRD or count % 3 == 0

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            if not is_meant():
                return await proceed(call)
            if form in _READ:
                return (await proceed(call)).never()
            return Reply() if form is Form.PUBLISH else Reply().never()

        return mutated

    def fault(self, subject: Subject, what: str) -> str:
        which = {"": "each", _THIRD: "every third", _CHANCE: "with a probability of 30 %, a"}[subject.variant]
        return f"{which} {what} is lost"
