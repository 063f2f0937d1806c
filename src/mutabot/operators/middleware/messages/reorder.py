"""reorder: a message is overtaken by the next one."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Middleware, Proceed, Reply
from mutabot.model.named import Form
from mutabot.operators.middleware._examples import PUBLISH, RECEIVE
from mutabot.operators.middleware._forms import FormOperator, form_of
from mutabot.operators.operator import Example, Subject


class Reorder(FormOperator):
    """Holds every other message back until the next one is through."""

    name = "reorder"
    summary = (
        "Messages change places, two by two: the second comes before the first. A last one alone is lost."
    )
    rank = 150
    remembers = True
    forms = frozenset({Form.PUBLISH, Form.RECEIVE, Form.FEEDBACK})
    examples: ClassVar[tuple[Example, ...]] = (
        Example(Subject(PUBLISH), {"x": 0.4}, earlier=({"x": 0.2},), performed=({"x": 0.4}, {"x": 0.2})),
        Example(Subject(PUBLISH), {"x": 0.2}, performed=(), note="is held back for the next one"),
        Example(
            Subject(RECEIVE),
            replied={"gap": 0.02},
            earlier=({"gap": 0.5},),
            performed=({},),
            received={"gap": 0.02},
            then=({"gap": 0.5},),
        ),
        Example(Subject(RECEIVE), replied={"gap": 0.5}, performed=({},), lost=True),
    )

    def least_calls(self, subject: Subject) -> int:
        return 2

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        held_call: Call | None = None
        held_reply: Reply | None = None

        async def sent(call: Call, proceed: Proceed) -> Reply:
            nonlocal held_call
            if held_call is None:
                held_call = call
                return Reply()
            old, held_call = held_call, None
            reply = await proceed(call)
            await proceed(old)
            return reply

        async def read(call: Call, proceed: Proceed) -> Reply:
            nonlocal held_reply
            reply = await proceed(call)
            if held_reply is None:
                held_reply = reply
                return reply.never()
            old, held_reply = held_reply, None
            return reply.followed_by(old)

        return sent if form_of(subject.operation) is Form.PUBLISH else read

    def fault(self, subject: Subject, what: str) -> str:
        return f"every other {what} comes after the next one"
