"""lose-answer: a service does what it is asked for, and its answer is lost."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Middleware, Proceed, Reply
from mutabot.model.named import Form
from mutabot.operators.middleware._examples import CALL
from mutabot.operators.middleware._forms import FormOperator
from mutabot.operators.operator import Example, Subject


class LoseAnswer(FormOperator):
    """Proceeds, and lets the program wait for ever, or be told of a failure."""

    name = "lose-answer"
    summary = (
        "A service does what it is asked for, but the program hears of a failure, or never of anything, as"
        " its middleware has it when an answer is lost."
    )
    rank = 440
    forms = frozenset({Form.CALL, Form.GOAL})
    examples: ClassVar[tuple[Example, ...]] = (Example(Subject(CALL), performed=({},), lost=True),)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        async def mutated(call: Call, proceed: Proceed) -> Reply:
            return (await proceed(call)).never()

        return mutated

    def fault(self, subject: Subject, what: str) -> str:
        return f"the answer to each {what} is lost"
